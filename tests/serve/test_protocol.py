"""grbl's protocol as a sender meets it: what is said and answered, where the machine stands."""

import ast
import re
from pathlib import Path

import pytest

from fraese import gcode
from fraese.control.state import Status
from fraese.errors import PortError
from fraese.motor.seams import CONTROL
from fraese.serve.codes import REFUSALS
from fraese.serve.inbox import Inbox, Sent
from tests.helpers import record
from tests.serve.sender import Bench, bench, unreferenced

OK = ["ok"]


@pytest.fixture
def at() -> Bench:
    return bench()


def test_a_sender_is_greeted(at: Bench) -> None:
    assert at.heard == ["Grbl 1.1h ['$' for help]"]
    assert at.ask().startswith("<Idle|MPos:0.000,0.000,0.000|FS:0,0|WCO:0.000,0.000,0.000>")
    assert at.ask().endswith("|Ov:100,100,100>")


def test_lines_move_the_machine_and_each_is_answered_once(at: Bench) -> None:
    assert at.say("G21 G90", "G0 X10 Y5 Z-1", "G1 X20 F600", "(remark)", "") == OK * 5
    assert at.at_mm == (20.0, 5.0, -1.0)
    assert at.word == "Idle"


def test_modes_outlive_a_rest(at: Bench) -> None:
    at.say("G91 G20 G1 F20 Z-0.1")
    at.say("X1")
    at.say("X1")
    assert at.at_mm == pytest.approx((50.8, 0, -2.54))
    assert at.say("$G") == ["[GC:G1 G54 G17 G20 G91 G94 M5 M9 T0 F20 S0]", "ok"]


def test_a_reset_begins_anew(at: Bench) -> None:
    at.say("G91 G20 G55")
    at.bytes(b"\x18")
    at.work()
    assert at.heard[-1] == "Grbl 1.1h ['$' for help]"
    assert at.say("$G")[0] == "[GC:G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0]"


@pytest.mark.parametrize(
    ("line", "code"),
    [
        ("G1 X5", 22), ("G0 G1 X5", 21), ("X5 X6", 25), ("G1 F100 Xabc", 2), ("hello", 1),
        ("G999", 20), ("G2 X5 F100", 35), ("G2 X5 Y5 R1 F100", 34), ("M98 P1", 20), ("O100", 20),
        ("G41 D1", 20), ("G1 F-1 X2", 4), ("G4", 28), ("G53 X1 G2 R3 F100", 30), ("G0 J3", 36),
        ("G2 I0 J0 F100", 33), ("$q", 3), ("$100=abc", 2), ("$100=-1", 4), ("$20=0", 5),
        ("$N5=G0", 3), ("G0 X" + "1" * 300, 11), ("$J=X10", 22), ("$J=F100", 26),
        ("$J=G0 X1 F100", 16), ("$J=X1000 F100", 15), ("$J=X1 X2 F100", 25), ("$HA", 3),
    ],
)  # fmt: skip
def test_what_is_wrong_has_grbls_number_and_moves_nothing(at: Bench, line: str, code: int) -> None:
    heard = at.say(line, "$$")
    assert [said for said in heard if not said.startswith(("[MSG:", "$"))] == [
        f"error:{code}",
        "ok",
    ]
    assert at.at_mm == (0.0, 0.0, 0.0)
    assert at.word == "Idle"


def test_after_a_refused_line_the_next_one_goes_on(at: Bench) -> None:
    heard = at.say("G0 X1", "G7 X2", "X3")
    assert [said for said in heard if not said.startswith("[")] == ["ok", "error:20", "ok"]
    assert at.at_mm[0] == 3.0


def test_a_stream_flows_through_its_corners(at: Bench) -> None:
    """As fast as the same moves planned as one program: none of them ends at rest."""
    lines = ["G1 F600"] + [f"G1 X{n / 2}" for n in range(1, 41)]
    at.bytes("".join(line + "\n" for line in lines).encode())
    before_ns = at.plant.clock.now_ns()
    at.work()
    assert at.heard.count("ok") == 41
    # 20 mm at 600 mm/min; each stop would cost a ramp, and a slice of the run loop.
    assert (at.plant.clock.now_ns() - before_ns) / 1e9 < 2.4
    assert at.controller.state().dry_queues == 0


def test_hold_and_resume(at: Bench) -> None:
    seen: list[str] = []

    def hold() -> None:
        at.bytes(b"!")
        seen.append(at.word)

    def go_on() -> None:
        seen.append(at.word)
        at.bytes(b"~")

    at.when(lambda: at.at_mm[0] > 2, hold)
    at.when(lambda: at.controller.state().held, go_on)
    assert at.say("G1 X20 F600").count("ok") == 1
    assert seen == ["Hold:1", "Hold:0"]
    assert at.at_mm[0] == 20.0


def test_a_hold_at_rest_keeps_lines_waiting(at: Bench) -> None:
    at.bytes(b"!")
    assert at.word == "Hold:0"
    assert at.say("G0 X5") == []
    at.bytes(b"~")
    at.work()
    assert at.at_mm[0] == 5.0


def test_an_open_door_is_a_hold(at: Bench) -> None:
    at.bytes(b"\x84")
    assert at.word == "Door:0"
    at.bytes(b"~")
    assert at.word == "Idle"


def test_a_reset_in_motion_brakes_and_locks(at: Bench) -> None:
    at.when(lambda: at.at_mm[0] > 2, lambda: at.bytes(b"\x18"))
    heard = at.say("G1 X50 F600", "G1 X0")
    assert heard[-3:] == ["ALARM:3", "Grbl 1.1h ['$' for help]", "[MSG:'$H'|'$X' to unlock]"]
    assert 2 < at.at_mm[0] < 10
    assert at.controller.position.referenced == (True,) * 3
    assert at.word == "Alarm"
    assert at.say("G0 X0", "$J=X1F100") == ["error:9", "error:8"]
    assert at.say("$X", "G0 X0") == ["[MSG:Caution: Unlocked]", "ok", "ok"]
    assert at.at_mm[0] == 0.0


def test_a_reset_after_a_hold_does_not_lock(at: Bench) -> None:
    at.when(lambda: at.at_mm[0] > 2, lambda: at.bytes(b"!"))
    at.when(lambda: at.controller.state().held, lambda: at.bytes(b"\x18"))
    assert at.say("G1 X50 F600")[-1] == "Grbl 1.1h ['$' for help]"
    assert at.say("G0 X0") == OK


def test_somebody_else_who_stops_it_takes_the_machine(at: Bench) -> None:
    at.when(lambda: at.at_mm[0] > 2, at.controller.cancel)
    assert "ALARM:3" in at.say("G1 X50 F600", "G1 X60", "G1 X70")
    assert at.word == "Alarm"
    assert 2 < at.at_mm[0] < 10


def test_who_goes_away_while_it_moves_stops_it(at: Bench) -> None:
    at.when(lambda: at.at_mm[0] > 2, at.session.lost)
    at.say("G1 X50 F600")
    assert 2 < at.at_mm[0] < 10
    at.session.connected("again", at._hear)
    at.work()
    assert at.heard[-1] == "[MSG:'$H'|'$X' to unlock]"


def test_beyond_the_travel_is_a_soft_limit(at: Bench) -> None:
    heard = at.say("G0 X5", "G0 X1000", "G0 X6")
    assert heard[0] == "ok"
    assert "ALARM:2" in heard
    assert heard[-1] == "[MSG:Reset to continue]"
    assert at.say("$X") == []
    at.bytes(b"\x18")
    at.work()
    assert at.heard[-1] == "[MSG:'$H'|'$X' to unlock]"
    assert at.say("$X")[-1] == "ok"
    assert at.say("G0 X1") == OK


def test_an_end_switch_is_a_hard_limit(at: Bench) -> None:
    at.when(lambda: at.at_mm[0] > 5, lambda: at.plant.press("xmax", True))
    heard = at.say("G1 X50 F600")
    assert "ALARM:1" in heard
    assert "Pn:X" in at.ask()


def test_a_machine_that_does_not_know_where_it_is_begins_locked() -> None:
    at = unreferenced()
    assert at.heard == ["Grbl 1.1h ['$' for help]", "[MSG:'$H'|'$X' to unlock]"]
    assert at.say("G0 X1") == ["error:9"]
    at.when(lambda: at.controller.state().running, lambda: at.ask())
    assert at.say("$H")[-1] == "ok"
    assert any(said.startswith("<Home|") for said in at.heard)
    assert all(at.controller.position.referenced)
    assert at.say("G0 X1") == OK


def test_one_axis_is_referenced_by_its_letter() -> None:
    at = unreferenced()
    assert at.say("$HZ") == ["[MSG:Referenced: Z.]", "ok"]
    assert at.controller.position.referenced == (False, False, True)


def test_jogs_follow_each_other_without_a_stop(at: Bench) -> None:
    words: list[str] = []
    at.when(lambda: at.at_mm[0] > 1, lambda: words.append(at.word))
    heard = at.say("G20", *["$J=G91 G21 X0.5 F600"] * 20)
    assert [said for said in heard if not said.startswith("<")] == OK * 21
    assert words == ["Jog"]
    assert at.at_mm[0] == pytest.approx(10)
    assert "G20" in at.say("$G")[0]
    assert at.say("$J=G53 X1 F20") == OK
    assert at.at_mm[0] == pytest.approx(25.4)


def test_a_jog_is_cancelled_without_an_alarm(at: Bench) -> None:
    at.when(lambda: at.at_mm[0] > 2, lambda: at.bytes(b"\x85"))
    assert at.say("$J=X50 F600", "$J=X60 F600") == OK * 2
    assert 2 < at.at_mm[0] < 10
    assert at.word == "Idle"
    assert at.say("G0 X0") == OK


def test_what_belongs_to_a_standstill_is_refused_in_motion(at: Bench) -> None:
    at.when(lambda: at.at_mm[0] > 2, lambda: at.bytes(b"$$\n$J=X1F100\n$G\n"))
    heard = at.say("G1 X20 F600")
    assert heard[:3] == ["ok", "error:8", "error:8"]
    assert heard[3].startswith("[GC:G1")


def test_a_jog_keeps_lines_of_a_program_out(at: Bench) -> None:
    at.when(lambda: at.at_mm[0] > 2, lambda: at.bytes(b"G0 X0\n"))
    assert at.say("$J=X20 F600") == ["ok", "error:9"]


def test_overrides_act_at_once_and_have_their_bounds(at: Bench) -> None:
    at.bytes(b"\x91\x91\x93\x95\x96")
    assert at.controller.handling.feed == pytest.approx(1.21)
    assert at.controller.handling.rapid == 0.5
    at.ask()
    assert "Ov:121,50,100" in at.ask() or "Ov:121,50,100" in at.heard[-2]
    at.bytes(b"\x92" * 30)
    assert at.controller.handling.feed == 0.1
    at.bytes(b"\x90\x97")
    assert (at.controller.handling.feed, at.controller.handling.rapid) == (1.0, 0.25)
    at.bytes(b"\x18")
    at.work()
    assert at.controller.handling.rapid == 1.0


def test_work_offsets_are_seen(at: Bench) -> None:
    at.say("G0 X10 Y20", "G10 L20 P1 X0 Y0", "G28.1")
    assert "WCO:10.000,20.000,0.000" in at.ask()
    heard = at.say("$#")
    assert heard[0] == "[G54:10.000,20.000,0.000]"
    assert "[G28:10.000,20.000,0.000]" in heard
    assert heard[-3:] == ["[TLO:0.000]", "[PRB:0.000,0.000,0.000:0]", "ok"]
    at.say("$10=2", "$13=1")
    assert "|WPos:0.0000,0.0000,0.0000|Bf:15,128|" in at.ask()


def test_a_dwell_is_answered_when_it_is_over(at: Bench) -> None:
    after: list[int] = []
    at.when(lambda: at.at_mm[0] >= 10, lambda: after.append(at.heard.count("ok")))
    at.say("G1 X10 F600", "G4 P0.1", "G0 X11")
    assert after == [1]
    assert at.heard.count("ok") == 3


def test_a_program_asks_by_a_hold(at: Bench) -> None:
    at.when(lambda: bool(at.controller.question), lambda: at.bytes(b"?~"))
    heard = at.say("G0 X1", "M0", "G0 X2")
    assert any(said.startswith("<Hold:0|") for said in heard)
    assert any(said.startswith("[MSG:") for said in heard)
    assert at.at_mm[0] == 2.0


def test_a_program_ends_and_another_begins(at: Bench) -> None:
    heard = at.say("G91 G55 G0 X1", "M30", "G0 X5")
    assert heard == ["ok", "[MSG:Pgm End]", "ok", "ok"]
    assert at.at_mm[0] == 5.0
    assert at.say("$G")[0].startswith("[GC:G0 G54")


def test_check_mode_moves_nothing(at: Bench) -> None:
    assert at.say("$C", "G1 X10 F100", "G7", "G91 X5") == [
        "[MSG:Enabled]", "ok", "ok",
        "[MSG:" + at.heard[at.heard.index("error:20") - 1][5:], "error:20", "ok",
    ]  # fmt: skip
    assert at.word == "Check"
    assert at.at_mm == (0.0, 0.0, 0.0)
    heard = at.say("$C")
    assert heard == ["[MSG:Disabled]", "ok", "Grbl 1.1h ['$' for help]"]
    assert at.word == "Idle"


def test_the_machine_is_free_between_lines(at: Bench) -> None:
    at.say("G91 G0 X5")
    at.controller.move_to({"x": 20})
    assert at.controller.run() is Status.OK
    at.say("X1")
    assert at.at_mm[0] == 21.0


def test_a_held_stream_lifts_its_tool_where_that_is_configured() -> None:
    at = bench(run={"retract_mm": 3})
    heights: list[float] = []

    def look() -> bool:
        state = at.controller.state()
        return state.held and state.position_mm[2] > -8

    def go_on() -> None:
        heights.append(at.at_mm[2])
        at.bytes(b"~")

    at.say("G0 Z-10")
    at.when(lambda: at.at_mm[0] > 2, lambda: at.bytes(b"!"))
    at.when(look, go_on)
    assert at.say("G1 X10 F600", "G1 Y5")[-1] == "ok"
    assert heights == [-7.0]
    assert at.at_mm == (10.0, 5.0, -10.0)


def test_single_block_waits_for_the_sender(at: Bench) -> None:
    at.controller.handling.switch("single_block")
    at.when(lambda: bool(at.controller.question), lambda: at.bytes(b"?~"))
    heard = at.say("G0 X1", "G0 X2")
    assert any(line.startswith("<Hold:0|") for line in heard)
    assert "[MSG:Single block: line 2 comes next.]" in heard
    assert at.at_mm[0] == 2.0


def test_a_machine_that_is_gone_is_told_of_and_every_line_is_answered(
    at: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    def gone(*how: object) -> None:
        raise PortError("The bridge does not answer.")

    monkeypatch.setattr(at.controller._queue, "look_around", gone)
    assert at.say("G0 X1", "$J=X1F100") == ["[MSG:The bridge does not answer.]", "error:9"] * 2
    at.bytes(b"\x18")
    at.work()
    assert at.heard[-1] == "Grbl 1.1h ['$' for help]"


def test_a_line_that_is_cleared_while_it_is_looked_at_is_not_taken_for_another() -> None:
    inbox = Inbox(waits=False)
    inbox.put(Sent("$J=X1F1"))
    first = inbox.head()
    assert first is not None
    inbox.clear()
    inbox.put(Sent("$J=X1F1"))
    assert not inbox.take(first)
    second = inbox.head()
    assert second is not None
    assert inbox.take(second)
    assert inbox.waiting_bytes == 0


def test_every_refusal_that_has_a_number_is_one_of_the_language() -> None:
    """A sentence that is worded otherwise must not lose its number unseen."""
    said = " ".join(
        str(node.args[0].value)
        for path in Path(gcode.__file__ or "").parent.glob("*.py")
        for node in ast.walk(ast.parse(path.read_text("utf-8")))
        if isinstance(node, ast.Call)
        and getattr(node.func, "id", "") == "phrase"
        and isinstance(node.args[0], ast.Constant)
    )
    filled = re.sub(r"\{[^}]*\}", "X", said)
    assert [
        part
        for pattern, _ in REFUSALS
        for part in pattern.split("|")
        if not re.search(part, filled)
    ] == []


def test_what_was_said_of_a_laser_and_of_corners_holds_behind_a_rest() -> None:
    at = bench(outputs={"laser": {"pin": 14}})
    recorder = record(at.plant)
    lit: list[bool] = []

    def look() -> bool:
        written = [each.value for each in recorder.accesses if each.register == CONTROL]
        lit.append(not written[-1] & 0b0010)
        return False

    at.say("G61.1", "M3 S1000", "G1 X1 F600")
    assert at.session.modes.doing.value == ""
    at.when(lambda: 2 < at.at_mm[0] < 3.9 and look(), lambda: None)
    assert at.say("G1 X4") == ["ok"]
    assert lit
    assert all(lit)
    assert at.say("$G")[0] == "[GC:G1 G54 G17 G21 G90 G94 M3 M9 T0 F600 S1000]"


def test_who_lets_a_held_stream_go_on_lets_all_of_it(at: Bench) -> None:
    at.when(lambda: at.at_mm[0] > 2, lambda: at.bytes(b"!"))
    at.when(lambda: at.controller.state().held, lambda: at.controller.resume() or True)
    assert at.say("G1 X10 F600")[-1] == "ok"
    assert at.word == "Idle"
    assert at.say("G0 X1") == ["ok"]


def test_a_sender_lets_nothing_go_on_that_somebody_else_has_held(at: Bench) -> None:
    seen: list[bool] = []

    def hold() -> None:
        at.controller.hold()
        at.bytes(b"~")

    def look() -> None:
        seen.append(at.controller.holding)
        at.controller.resume()

    at.when(lambda: at.at_mm[0] > 2, hold)
    at.when(lambda: at.controller.state().held, look)
    at.controller.move_to({"x": 10}, feed_mm_min=600)
    assert at.controller.run() is Status.OK
    assert seen == [True]


def test_who_has_taken_over_is_not_disturbed(at: Bench) -> None:
    at.session.take(out=True)
    at.work()
    assert at.word == "Alarm"
    at.bytes(b"\x91~\x96")
    assert at.controller.handling.feed == 1.0
    assert at.controller.handling.rapid == 1.0
    assert at.say("$X", "$H", "G0 X1", "$G")[:3] == [
        "[MSG:Somebody at the machine has taken over.]", "error:9",
        "[MSG:Somebody at the machine has taken over.]",
    ]  # fmt: skip
    assert at.at_mm[0] == 0.0
    at.session.take(out=False)
    assert at.say("$X", "G0 X1")[-1] == "ok"
    assert at.at_mm[0] == 1.0


def test_a_slow_sender_flows_through_its_corners_too(at: Bench) -> None:
    """A line comes only when the run loop has been round: there is still motion enough by then."""
    lines = [f"G1 X{n * 2}\n".encode() for n in range(1, 51)]

    def send_one() -> bool:
        if lines and at.heard.count("ok") > 50 - len(lines):
            at.bytes(lines.pop(0))
        return False

    at.bytes(b"G1 F1100\n" + lines.pop(0) + lines.pop(0) + lines.pop(0))
    at.when(send_one, lambda: None)
    before_ns = at.plant.clock.now_ns()
    at.work()
    assert at.at_mm[0] == 100
    # 100 mm at 1100 mm/min; with a stop at each corner it takes ten seconds.
    assert (at.plant.clock.now_ns() - before_ns) / 1e9 < 6.2
