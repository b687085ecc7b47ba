"""The test program: its grammar, its limits, its sessions, and a person at a terminal."""

import io
import os
import pty
import re
import select
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import pytest
from typer.testing import CliRunner

from fraese.cli import app
from fraese.x4step import X4Init, X4ReInit
from fraese.x4step.bench import COMMANDS, HELP, Bench
from fraese.x4step.consoles import ScriptConsole, TerminalConsole
from fraese.x4step.keys import HandKeys, Keyboard
from fraese.x4step.testing import BOOST_PIN, Lab, clock_pin, direction_pin, simulation
from tests.cli.test_trace_option import Wave

ROOT = Path(__file__).parents[2]
MS = 1_000_000


@dataclass
class Session:
    """A script that was run, and what came of it."""

    lab: Lab
    said: list[str] = field(default_factory=list)
    prompts: list[str] = field(default_factory=list)

    def run(self, script: str, lpt: int = 1) -> "Session":
        console = ScriptConsole(script, self.said.append, self.prompts.append)
        console.keys = self.lab.keys
        assert X4Init(lpt) == 0
        self.bench = Bench(console)
        self.bench.run()
        assert X4ReInit() == 0
        return self

    def rises(self, axis: int) -> list[int]:
        return self.lab.lines().rises(clock_pin(axis))

    def motions(self, axis: int) -> list[list[int]]:
        """Rising edges, motion by motion."""
        active = self.lab.lines()
        parts = zip(active.rises(17), active.falls(17), strict=True)
        return [[at for at in self.rises(axis) if up <= at <= down] for up, down in parts]


@pytest.fixture
def session() -> Iterator[Session]:
    with simulation() as lab:
        yield Session(lab)
        X4ReInit()


def rates(rises: list[int]) -> list[float]:
    return [1e9 / (b - a) for a, b in pairwise(rises)]


def test_all_commands_are_listed_at_once_and_again_on_demand(session: Session) -> None:
    session.run("h\n?\nH\n")
    assert session.said.count(HELP) == 4
    assert session.said[0] == HELP
    for letter in COMMANDS:
        assert re.search(rf"^  .*{re.escape(letter)}", HELP, re.MULTILINE)
    assert "Lewetz" in HELP
    assert session.prompts[0] == "1->"


def test_session_1_one_axis(session: Session) -> None:
    session.run("s1\nd1000\nf2000\nr50\ng\n")
    assert session.lab.lines().steps(1) == 1000
    assert max(rates(session.rises(1))) == pytest.approx(2000, rel=0.002)
    boost = session.lab.lines()
    stretches = [b - a for a, b in zip(boost.rises(BOOST_PIN), boost.falls(BOOST_PIN), strict=True)]
    assert sum(at > 20 * MS for at in stretches) == 2
    assert "Steps of axes 1 to 4: 1000, 0, 0, 0." in session.said


def test_session_2_three_axes_in_a_straight_line(session: Session) -> None:
    session.run("s1\nd1000\nf10000\nr100\ns2\nd500\ns3\nd100\ng\n")
    lines = session.lab.lines()
    assert [lines.steps(axis) for axis in (1, 2, 3, 4)] == [1000, 500, 100, 0]
    # A thousand steps are just a ramp up and a ramp down: a little below the rate.
    assert 9800 < max(rates(session.rises(1))) <= 10_000
    ticks = session.rises(1)
    seconds = set(session.rises(2))
    made = 0
    for done, at_ns in enumerate(ticks, 1):
        made += at_ns in seconds
        assert abs(made - done / 2) <= 1


def test_session_3_a_sweep_takes_its_end_along(session: Session) -> None:
    session.run("s2\nd1000\nr0\na200,500,20\n", lpt=2)
    motions = session.motions(2)
    assert [len(motion) for motion in motions] == [1000] * 16
    for rate, motion in zip(range(200, 501, 20), motions, strict=True):
        assert min(rates(motion)) == pytest.approx(rate, rel=0.002)
        assert max(rates(motion)) == pytest.approx(rate, rel=0.002)
    assert session.lab.lines().steps(2) == 16_000
    ups, downs = (getattr(session.lab.lines(), kind)(BOOST_PIN) for kind in ("rises", "falls"))
    assert all(b - a < MS for a, b in zip(ups, downs, strict=True))


def test_session_4_to_and_fro_until_escape(session: Session) -> None:
    session.run("s1\nd2000\nf5000\nr100\nt\n\x1b\n")
    # The last one may have been braked before its first step.
    motions = [motion for motion in session.motions(1) if motion]
    lines = session.lab.lines()
    signs = [lines.level(direction_pin(1), motion[0]) for motion in motions]
    assert signs == [number % 2 == 0 for number in range(len(motions))]
    assert all(len(motion) == 2000 for motion in motions[:-1])
    assert len(motions) >= 2
    assert len(motions[-1]) <= 2000


def test_session_5_endless_until_escape(session: Session) -> None:
    session.run("s3\nf10000\nr500\nm+\n\x1bi\n")
    lines = session.lab.lines()
    assert lines.steps(3) == pytest.approx(10_000, abs=300)
    ups, downs = lines.rises(BOOST_PIN), lines.falls(BOOST_PIN)
    assert downs[0] - ups[0] == pytest.approx(500 * MS, rel=0.05)
    assert any("Ended by ESC." in line for line in session.said)
    assert session.prompts[-1] == "3->"


def test_the_other_way(session: Session) -> None:
    session.run("s4\nf1000\nm-\n")
    assert session.lab.lines().steps(4) < -900


@pytest.mark.parametrize(
    ("line", "axis", "kept"),
    [("d16777216", "steps", 16_777_216), ("d-16777216", "steps", -16_777_216), ("d0", "steps", 0),
     ("D+5", "steps", 5), (" d 1 000 ", "steps", 1000), ("F10", "freq_hz", 10),
     ("f20000", "freq_hz", 20_000), ("r0", "ramp_ms", 0), ("R1000", "ramp_ms", 1000)],
)  # fmt: skip
def test_what_is_loaded(session: Session, line: str, axis: str, kept: int) -> None:
    session.run(f"s2\n{line}\n")
    assert getattr(session.bench.axes[2], axis) == kept
    assert all(not line.endswith(".") for line in session.said[1:])


@pytest.mark.parametrize(
    "line",
    ["d16777217", "d-16777217", "f9", "f20001", "f-1", "r1001", "r-1", "s0", "s5", "s-1",
     "a9,500,20", "a200,20001,20", "a500,200,20", "a200,500,0", "a200,500,-1"],
)  # fmt: skip
def test_what_is_out_of_range_is_said_and_changes_nothing(session: Session, line: str) -> None:
    session.run(f"s2\nd7\nf70\nr17\n{line}\n")
    assert session.said[-1].endswith(".")
    assert session.bench.axis == 2
    kept = session.bench.axes[2]
    assert (kept.steps, kept.freq_hz, kept.ramp_ms) == (7, 70, 17)
    assert session.rises(2) == []


@pytest.mark.parametrize(
    "line", ["s", "sx", "s1x", "d", "dx", "d1.5", "f", "r", "m", "m1", "g1", "a", "a1,2", "x",
             "qq", "a1,2,3,4", "--", "i2", "ä"],
)  # fmt: skip
def test_what_is_no_command_is_said(session: Session, line: str) -> None:
    session.run(f"{line}\n")
    assert "no such command" in session.said[-1]
    assert session.bench.axis == 1


def test_an_empty_line_says_nothing(session: Session) -> None:
    session.run("\n   \n\n")
    assert session.said[1:] == ["", "   ", ""]


def test_of_two_longest_paths_the_one_with_a_rate_leads(session: Session) -> None:
    session.run("d50\ns3\nd-50\nf1000\ng\n")
    assert [session.lab.lines().steps(axis) for axis in (1, 3)] == [50, -50]
    assert max(rates(session.rises(3))) == pytest.approx(1000, rel=0.002)


def test_without_a_path_nothing_moves(session: Session) -> None:
    session.run("f1000\ng\nt\na200,300,100\n")
    assert [line for line in session.said if line.startswith("X4")] == [
        "X4ErrNoSteps (1): At least one axis must have at least one step to make."
    ] * 3
    assert session.rises(1) == []


def test_without_a_rate_nothing_moves(session: Session) -> None:
    session.run("d100\ng\nm+\nc\n")
    assert sum(line.startswith("X4ErrFreqTooLow (3)") for line in session.said) == 3
    assert session.rises(1) == []


def test_values_stay_for_the_next_go(session: Session) -> None:
    session.run("d100\nf1000\nr10\ng\ng\nd-50\ng\n")
    assert [len(motion) for motion in session.motions(1)] == [100, 100, 50]
    assert session.lab.lines().steps(1) == 150


def test_a_rate_below_the_ramp_ends_a_sweep(session: Session) -> None:
    session.run("d10\nr100\na90,110,10\n")
    assert session.said[-1].startswith("X4ErrRampFreq (5)")
    assert session.rises(1) == []


def test_escape_ends_the_whole_sweep(session: Session) -> None:
    session.run("d1000\nr0\na200,500,100\n\x1bi\n")
    assert len(session.motions(1)) == 1
    assert len(session.rises(1)) == pytest.approx(200, abs=5)
    assert session.said.count("Ended by ESC.") == 1


def test_escape_brakes_a_go(session: Session) -> None:
    session.run("d10000\nf1000\nr100\ng\n\x1b\n")
    assert session.rises(1) == pytest.approx(session.rises(1))
    assert len(session.rises(1)) == pytest.approx(1000, abs=50)


def test_all_axes_are_shown(session: Session) -> None:
    session.run("s4\nd-16777216\nf20000\nr1000\ni\n")
    shown = session.said[-4:]
    assert [line.split(":")[0] for line in shown] == [f"axis {axis}" for axis in (1, 2, 3, 4)]
    assert shown[3].split() == ["axis", "4:", "-16777216", "steps", "20000", "Hz", "1000", "ms"]


def test_inputs_are_shown_when_they_change(session: Session) -> None:
    class Watch(ScriptConsole):
        def press_if_due(watch, elapsed_ms: int, only_esc_ends: bool) -> bool:  # noqa: N805
            session.lab.set_pin(15, elapsed_ms < 300)
            return super().press_if_due(elapsed_ms, only_esc_ends)

    console = Watch("e\n", session.said.append, session.prompts.append)
    X4Init(1)
    Bench(console).run()
    levels = [line for line in session.said if line.startswith("pin 11")]
    assert levels == [
        "pin 11: 1  pin 10: 1  pin 12: 1  pin 13: 1  pin 15: 1",
        "pin 11: 1  pin 10: 1  pin 12: 1  pin 13: 1  pin 15: 0",
    ]


def test_cursor_keys_move_while_they_are_held(session: Session) -> None:
    class Hand(ScriptConsole):
        pressed = iter([77, 75, 30, 1])

        def code(self) -> int | None:
            code = next(self.pressed)
            if code in (75, 77):
                session.lab.at_ms(200, lambda: session.lab.release(code))
            return code

        def press_if_due(self, elapsed_ms: int, only_esc_ends: bool) -> bool:
            return False

    X4Init(1)
    Bench(Hand("f1000\nr50\nc\n", session.said.append, session.prompts.append)).run()
    right, left = session.motions(1)
    lines = session.lab.lines()
    assert lines.level(direction_pin(1), right[0])
    assert not lines.level(direction_pin(1), left[0])
    assert len(right) == pytest.approx(200, abs=10)
    assert len(left) == pytest.approx(200, abs=10)


# --- the command ----------------------------------------------------------------------------


def command(*arguments: str, text: str = "") -> "subprocess.CompletedProcess[str]":
    return subprocess.run(
        [sys.executable, "-m", "fraese", "bench", *arguments],
        cwd=ROOT,
        input=text,
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "XDG_CONFIG_HOME": "/nowhere"},
    )


@pytest.mark.parametrize("lpt", ["0", "5", "x", "-1", "1.5", ""])
def test_a_number_that_is_no_port(lpt: str) -> None:
    done = command(lpt)
    assert done.returncode == 2
    assert done.stderr.endswith("it is 1 to 4, as in fraese bench 2.\n")


@pytest.mark.parametrize("arguments", [(), ("2",), ("4",)])
def test_a_script(arguments: tuple[str, ...]) -> None:
    """It ends by Q; see below for the end of the input."""
    done = command(*arguments, text="s1\nd1000\nf2000\nr50\ng\nq\nd7\n")
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("Test program for X4Step")
    assert "1->g\nSteps of axes 1 to 4: 1000, 0, 0, 0.\n" in done.stdout
    assert "d7" not in done.stdout


def test_ctrl_c_in_a_motion_is_not_said_to_be_before_it(monkeypatch: pytest.MonkeyPatch) -> None:
    def pressed(*_: object) -> bool:
        raise KeyboardInterrupt

    monkeypatch.setenv("XDG_CONFIG_HOME", "/nowhere")
    monkeypatch.setattr(ScriptConsole, "press_if_due", pressed)
    ended = CliRunner().invoke(app, ["bench"], input="f1000\nm+\n")
    assert ended.exit_code == 130
    assert ended.stderr == "fraese: Cancelled; the motors are off.\n"


@pytest.mark.parametrize("end", ["q\n", ""])
def test_the_lines_are_low_after_it(tmp_path: Path, end: str) -> None:
    file = tmp_path / "lines.vcd"
    done = command("3", "--trace", str(file), text=f"d20\nf1000\ng\nm-\n{end}")
    assert done.returncode == 0, done.stderr
    wave = Wave(file)
    outputs = [name for name in wave.changes if "input" not in name and "direction" not in name]
    assert len(outputs) == 8
    assert all(wave.changes[name][-1].value == "0" for name in outputs)
    assert len(wave.edges("pin17_active", "1")) == 2


class Person:
    """At a terminal, in front of the test program."""

    def __init__(self) -> None:
        child, self._screen = pty.fork()
        if child == 0:
            os.environ["XDG_CONFIG_HOME"] = "/nowhere"
            os.chdir(ROOT)
            os.execv(sys.executable, [sys.executable, "-m", "fraese", "bench"])
        self._child = child
        self.seen = ""
        self._mark = 0

    def wait_for(self, text: str) -> None:
        until_s = time.monotonic() + 30
        while text not in self.seen[self._mark :]:
            assert select.select([self._screen], [], [], until_s - time.monotonic())[0], self.seen
            self.seen += os.read(self._screen, 1024).decode().replace("\r\n", "\n")
        self._mark = self.seen.index(text, self._mark) + len(text)

    def type(self, data: bytes) -> None:
        os.write(self._screen, data)

    def leave(self) -> int:
        try:
            while chunk := os.read(self._screen, 1024):
                self.seen += chunk.decode().replace("\r\n", "\n")
        except OSError:
            pass
        return os.waitstatus_to_exitcode(os.waitpid(self._child, 0)[1])


@pytest.mark.alone
def test_a_person_at_a_terminal() -> None:
    person = Person()
    person.wait_for("1->")
    # All at once: what is typed ahead comes later.
    person.type(b"f2000\nr50\nd300\ng\ni\n")
    person.wait_for("Steps of axes 1 to 4: 300, 0, 0, 0.")
    person.wait_for("axis 4:")
    person.wait_for("1->")
    person.type(b"m+\n")
    person.wait_for("Moving")
    time.sleep(0.4)
    person.type(b"nothing\x1b[D")
    time.sleep(0.2)
    begin_s = time.monotonic()
    person.type(b"\x1b")
    person.wait_for("Ended by ESC.")
    assert time.monotonic() - begin_s < 2
    person.wait_for("1->")
    person.type(b"c\n")
    person.wait_for("ESC ends it.")
    person.type(b"\x1b[C")
    person.wait_for("Steps of axes 1 to 4: ")
    person.type(b"\x1b[D")
    person.wait_for("Steps of axes 1 to 4: -")
    person.type(b"\x1b")
    person.wait_for("1->")
    person.type(b"e\n")
    person.wait_for("pin 15: 1")
    person.type(b"\x1b")
    person.wait_for("1->")
    person.type(b"q\n")
    assert person.leave() == 0
    assert "nothing" not in person.seen


@pytest.mark.alone
def test_the_end_of_the_terminals_input_is_the_end() -> None:
    person = Person()
    person.wait_for("1->")
    person.type(b"\x04")
    assert person.leave() == 0


def test_escape_at_the_prompt_is_no_part_of_a_command() -> None:
    lines = io.StringIO("\x1bS 100\n\x1b\n")
    console = TerminalConsole(Keyboard(HandKeys()), lines, print, print)
    assert [console.line("1->") for _ in range(3)] == ["S 100\n", "\n", None]
