"""The recorder: the truth lies within what the last record says, at every moment of every run.

Truth are the driver's counts and the simulated mill's carriages, looked at when a record is written
and when the run loop has polled; what is claimed is read from the journal's file.
"""

import json
import threading
from dataclasses import replace
from functools import partial
from itertools import count
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fraese import alarms
from fraese.alarms import AlarmKind
from fraese.assembly import Plant, assemble
from fraese.blocks import CYCLES_PER_S, Block, steps_done
from fraese.control.bounds import Span, box_of
from fraese.control.recorder import JournalRecorder
from fraese.control.savedstate import SavedState, state_in
from fraese.control.state import Status
from fraese.errors import ConfigError, PortError
from fraese.journal import files, store
from fraese.motor.seams import Report
from fraese.planner.lines import plan_line, planned_s
from tests.helpers import after_slices, configured, crash, kept, plant, program

MACHINE = plant().controller.machine
RATES_HZ = [axis.max_rate_hz for axis in MACHINE.axes]

ZIGZAG = "G21 G90\n" + "".join(f"G1 X{n % 7} Y{n % 5} F600\n" for n in range(60)) + "M2\n"


def position_is_within(folder: Path, made: Plant) -> bool:
    """The record in force bounds where the machine is now."""
    values = kept(folder)
    motion, at = values["motion"], made.controller.position.position_steps
    if motion is None:
        return bool(values["position_steps"] == list(at))
    bounds = zip(motion["low_steps"], at, motion["high_steps"], strict=True)
    return all(low <= here <= high for low, here, high in bounds)


@pytest.mark.parametrize("clock", ["virtual", "paced"])
def test_at_every_look_the_record_bounds_where_the_machine_is(tmp_path: Path, clock: str) -> None:
    made = assemble(configured(), state=tmp_path, clock="paced" if clock == "paced" else "virtual")
    seen: list[bool] = []
    made.controller.set_break_key(lambda: seen.append(position_is_within(tmp_path, made)))
    text = ZIGZAG if clock == "virtual" else "G1 X3 F600\nX0 Y1\nM2\n"
    program(tmp_path, text).start(made.controller)
    assert made.controller.run() is Status.OK
    made.close()
    assert len(seen) > 5
    assert all(seen)
    values = kept(tmp_path)
    assert values["motion"] is None
    assert values["position_steps"] == list(made.controller.position.position_steps)


def test_a_machine_that_is_faster_than_time_does_not_wait_for_its_records(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On the virtual clock minutes of motion go by between two looks at the real one."""
    made = assemble(configured(), state=tmp_path)
    recorder = made.controller._queue.recorder
    assert isinstance(recorder, JournalRecorder)
    monkeypatch.setattr(recorder, "_now_ns", lambda: 1_000_000_000)
    text = "G1 F1000\n" + "X40 Y30\nX0 Y0\n" * 5 + "M2\n"
    program(tmp_path, text).start(made.controller)
    assert made.controller.run() is Status.OK
    assert made.controller.state().dry_queues == 0
    made.close()


def test_a_record_says_how_the_carriage_lags_in_the_middle_of_a_block_too(tmp_path: Path) -> None:
    """Carriage, motor and slack of one moment: what they come to never changes."""
    made = assemble(configured(axes={"x": {"backlash_mm": 0.5}}), state=tmp_path)
    seen: set[tuple[int, int]] = set()

    def look() -> None:
        values = json.loads(made.controller.keep().model_dump_json())
        motor = made.controller._queue.report.position_steps[0]
        slack = values["slack_steps"][0]
        seen.add((values["position_steps"][0] - motor - slack, slack))

    made.controller.set_break_key(look)
    # Slow, so that the motor is seen while it takes up the slack.
    text = "F60\n" + "G1 X1\nX0\n" * 3 + "M2\n"
    program(tmp_path, text).start(made.controller)
    assert made.controller.run() is Status.OK
    made.close()
    assert {constant for constant, _ in seen} == {0}
    assert len({slack for _, slack in seen}) > 3


def test_the_mark_is_durable_before_the_first_step(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A power cut at any moment later finds it: only what was synced counts."""
    made = assemble(configured(), state=tmp_path)
    journal = tmp_path / "simulation.journal"
    on_disk: list[bytes] = []
    sync, replace = files.sync, files.replace

    def synced(fd: int) -> None:
        sync(fd)
        on_disk.append(journal.read_bytes())

    def replaced(path: Path, content: bytes) -> None:
        replace(path, content)
        on_disk.append(content)

    monkeypatch.setattr(store, "sync", synced)
    monkeypatch.setattr(store, "replace", replaced)
    claims: list[bool] = []

    def cut() -> None:
        cut_here = tmp_path / "cut"
        cut_here.mkdir(exist_ok=True)
        (cut_here / "simulation.journal").write_bytes(on_disk[-1])
        moved = any(made.controller.travelled_steps())
        claims.append(not moved or kept(cut_here)["motion"] is not None)

    made.controller.set_break_key(cut)
    made.controller.jog("x", 20)
    assert made.controller.run() is Status.OK
    crash(made)
    assert claims
    assert all(claims)


def test_what_changes_at_rest_is_kept_while_idle(tmp_path: Path) -> None:
    """An app that is killed while nothing moves loses nothing."""
    made = assemble(configured(), state=tmp_path)
    now_ns = [10**12]
    made.recorder._now_ns = lambda: now_ns[0]  # type: ignore[attr-defined]
    made.controller.home()
    assert made.controller.run() is Status.OK
    made.controller.jog("x", 12.345)
    assert made.controller.run() is Status.OK
    assert kept(tmp_path)["motion"] is not None
    for _ in range(25):
        now_ns[0] += 50_000_000
        made.controller.idle(0.05)
    assert kept(tmp_path)["motion"] is None
    made.controller.set_zero("x", 2)
    for _ in range(10):
        now_ns[0] += 50_000_000
        made.controller.idle(0.05)
    where, work = made.controller.state().position_steps, made.controller.state().work_mm
    crash(made)
    again = assemble(configured(), state=tmp_path)
    state = again.controller.state()
    assert (state.position_steps, state.work_mm) == (where, work)
    assert state.referenced == (True, True, True)
    (note,) = again.notes
    assert "the position is as it was left" in note


def test_a_place_that_cannot_be_kept_brakes_the_job(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = assemble(configured(), state=tmp_path)

    def broken(*arguments: object) -> None:
        raise OSError(5, "Input/output error")

    def breaks() -> None:
        if any(made.controller.travelled_steps()):
            monkeypatch.setattr(store, "write_all", broken)

    # However fast it runs: between two looks there is time for a record.
    made.recorder._now_ns = count(10**12, 10**8).__next__  # type: ignore[attr-defined]
    made.controller.set_break_key(breaks)
    program(tmp_path, ZIGZAG).start(made.controller)
    assert made.controller.run() is Status.ERROR
    error = made.controller.error
    assert error is not None
    assert error.exit_code == 1
    assert "could not be kept" in str(error)
    assert "Input/output error" in str(error)
    assert not made.controller.state().running


def test_before_motion_it_is_refused_and_nothing_moves(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = assemble(configured(), state=tmp_path)

    def broken(*arguments: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(store, "replace", broken)
    made.controller.jog("x", 1)
    with pytest.raises(ConfigError, match="No space left on device"):
        made.controller.run()
    assert made.controller.travelled_steps() == (0, 0, 0)
    monkeypatch.undo()
    made.controller.jog("x", 1)
    assert made.controller.run() is Status.OK


def test_the_program_and_its_line_are_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made = assemble(configured(), state=tmp_path)
    # However fast this computer is: a record is due at every look.
    monkeypatch.setattr(made.recorder, "_now_ns", partial(next, count(10**9, 300_000_000)))
    part = program(tmp_path, ZIGZAG)
    part.start(made.controller)
    seen: list[tuple[str, str, int]] = []

    def look() -> None:
        # What was asked for is written by a thread of its own, which a busy machine lets wait.
        made.recorder.wait(5)
        job = kept(tmp_path)["job"]
        if job is not None:
            seen.append((job["name"], job["content_hash"], job["line"]))

    made.controller.set_break_key(look)
    assert made.controller.run() is Status.OK
    made.close()
    assert {(name, content) for name, content, _ in seen} == {("part.ngc", part.content_hash)}
    lines = [line for *_, line in seen]
    assert lines == sorted(lines)
    assert lines[-1] > 10
    # It came to its end: there is nothing to go on with.
    assert kept(tmp_path)["job"] is None


def test_who_stopped_without_ramp_does_not_move_before_that_is_on_the_disk(tmp_path: Path) -> None:
    """A crash in between would find an axis trusted that had turned on."""
    written: list[tuple[SavedState, int]] = []
    now_ns, free = [10**9], threading.Semaphore(1)

    def write(state: SavedState, durable: bool) -> None:
        assert free.acquire(timeout=5)
        written.append((state, now_ns[0]))

    queue = plant().controller._queue
    recorder = JournalRecorder(write, MACHINE, 1.0, lambda: now_ns[0])
    recorder.attach(queue)
    where = queue._position
    recorder.begin(lambda: SavedState.of(where, (0, 0, 0), ()))
    for name in MACHINE.names:
        where.set_reference(name, 0)
    block = blocks([(100, 0, 0)])[0]
    span = Span(block, block.ticks(), 0, planned_s(block))
    recorder.require([span])
    assert len(written) == 1
    assert recorder.allows((100, 0, 0), span)
    # The stop key, at speed; it may move in the same bounds again, but not before that is known.
    now_ns[0] += 1
    queue.report = replace(queue.report, torn=frozenset({0}))
    where.lose_reference({0})
    assert not recorder.allows((100, 0, 0), span)
    recorder.follow()
    assert not recorder.allows((100, 0, 0), span)
    assert len(written) == 1
    free.release()
    recorder.wait(5)
    assert recorder.allows((100, 0, 0), span)
    assert [state.referenced[0] for state, _ in written] == [True, False]
    # It has moved since.
    queue.report = replace(queue.report, torn=frozenset())
    assert recorder.allows((100, 0, 0), span)
    recorder._writer.close()


@pytest.mark.parametrize("backlash_steps", [0, 10])
def test_what_made_the_steps_died_and_the_record_says_what_the_alarm_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, backlash_steps: int
) -> None:
    made = assemble(
        configured(axes={"y": {"inverted": True}, "z": {"backlash_mm": backlash_steps / 200}}),
        state=tmp_path,
    )
    controller = made.controller
    controller.move_to({"x": 20, "y": 10, "z": -2}, machine_coordinates=True)
    driver = controller._loop._driver
    alarm = PortError(
        "It died.",
        alarms.STEP_PROCESS_DIED,
        at_steps=(1500, -700, -150),
        low_steps=(1500, -701, -151),
        high_steps=(1501, -700, -150),
    )

    def dies(budget_s: float) -> Report:
        raise alarm

    after_slices(controller, 3, lambda: monkeypatch.setattr(driver, "poll", dies))
    assert controller.run() is Status.ERROR
    assert controller.error is alarm
    at = controller.state().position_steps
    assert at[:2] == (1500, 700)
    # The next current is that of this place: that of where it was seen last would turn the rotors.
    assert [phase % 8 for phase in kept(tmp_path)["phases"]] == [1500 % 8, -700 % 8, -150 % 8]
    # Killed now, or ended in order: nothing is narrower, nothing is the whole machine.
    bounds = [(1500, 1501), (700, 701), (-151, -150)]
    doubted = controller.position.bounds_steps()
    assert doubted[:2] == bounds[:2]
    assert doubted[2][0] <= -151
    assert doubted[2][1] - doubted[2][0] == 1 + backlash_steps
    crashed = state_in(json.dumps(kept(tmp_path)).encode(), 3, "").believed()
    monkeypatch.undo()
    made.close()
    ended = state_in(json.dumps(kept(tmp_path)).encode(), 3, "").believed()
    for state, more in ((crashed, 1), (ended, 0)):
        assert state.position_steps == at
        assert state.referenced == (False, False, False)
        assert state.doubt is not None
        between = [
            (here - below, here + above)
            for here, (below, above) in zip(at, state.doubt.spans_steps, strict=True)
        ]
        assert between == [(low - more, high + more) for low, high in doubted]


@pytest.mark.parametrize("kind", [alarms.BRIDGE_LOST, alarms.PORT_LOST, alarms.BRIDGE_STUCK])
def test_what_was_given_bounds_the_place_where_nobody_tells_any_more(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: AlarmKind
) -> None:
    """In the alarm's parameters, the position, and the record; not in a sentence only."""
    made = assemble(configured(axes={"y": {"inverted": True}}), state=tmp_path)
    controller = made.controller
    controller.move_to({"x": 20, "y": 10}, machine_coordinates=True)
    driver = controller._loop._driver
    alarm = PortError("It is gone.", kind)

    def gone(budget_s: float) -> Report:
        raise alarm

    after_slices(controller, 3, lambda: monkeypatch.setattr(driver, "poll", gone))
    assert controller.run() is Status.ERROR
    seen = controller._queue.report.position_steps
    assert 0 < seen[0] < 4000
    parameters = alarm.as_dict()["parameters"]
    assert parameters == {
        "at_steps": seen,
        "low_steps": (seen[0], -2000, 0),
        "high_steps": (4000, seen[1], 0),
    }
    bounds = [(seen[0], 4000), (-seen[1], 2000), (0, 0)]
    assert controller.position.bounds_steps() == bounds
    crashed = state_in(json.dumps(kept(tmp_path)).encode(), 3, "").believed()
    monkeypatch.undo()
    made.close()
    ended = state_in(json.dumps(kept(tmp_path)).encode(), 3, "").believed()
    for state, more in ((crashed, 1), (ended, 0)):
        assert state.referenced == (False, False, False)
        assert state.doubt is not None
        assert state.doubt.spans_steps == tuple(
            (at - low + more, high - at + more)
            for at, (low, high) in zip(state.position_steps, bounds, strict=True)
        )


# --- bounds --------------------------------------------------------------------------------------

ways = st.lists(st.tuples(*[st.integers(-3000, 3000)] * 3).filter(any), min_size=1, max_size=5)


def blocks(made: list[tuple[int, ...]]) -> list[Block]:
    planned = [plan_line(MACHINE, way, 600.0) for way in made]
    return [block for block in planned if block is not None]


@given(ways, st.floats(0, 1), st.floats(0.05, 3), st.floats(0, 1))
@settings(max_examples=50)
def test_whatever_is_played_within_the_horizon_is_within_the_box(
    made: list[tuple[int, ...]], begun: float, horizon_s: float, when: float
) -> None:
    """Played tick by tick as planned; looked at at any time until the horizon."""
    line = blocks(made)
    ticks = [block.ticks() for block in line]
    done = min(int(begun * ticks[0]), ticks[0] - 1)
    spans = [
        Span(block, n, done if block is line[0] else 0, planned_s(block))
        for block, n in zip(line, ticks, strict=True)
    ]

    def after(block: Block, n: int) -> tuple[int, ...]:
        return tuple(
            (1 if steps > 0 else -1) * steps_done(abs(steps), block.ticks(), n)
            for steps in block.steps
        )

    here = after(line[0], done)
    box = box_of(here, (0, 0, 0), spans, horizon_s, RATES_HZ, 0.0)
    left = when * horizon_s * CYCLES_PER_S
    start: tuple[int, ...] = (0, 0, 0)
    for number, block in enumerate(line):
        tick = 0
        for piece in block.pieces:
            for k in range(piece.ticks):
                if number or tick >= done:
                    left -= (piece.interval_q8 + k * piece.add_q8) >> 8
                    if left < 0:
                        return
                tick += 1
                at = tuple(a + b for a, b in zip(start, after(block, tick), strict=True))
                assert (number == 0 and tick <= done) or box.holds(at)
        start = tuple(a + b for a, b in zip(start, block.steps, strict=True))


@pytest.mark.parametrize("by_hand", [False, True])
def test_who_waited_until_the_record_said_at_rest_moves_again(
    tmp_path: Path, by_hand: bool
) -> None:
    """A question is answered after minutes: the job goes on, or somebody jogs first."""
    made = assemble(configured(), state=tmp_path, clock="paced")
    controller = made.controller
    rested: list[bool] = []

    def answer() -> None:
        if controller.question and kept(tmp_path)["motion"] is None:
            if by_hand and not rested:
                controller.jog("z", 0.5)
            else:
                controller.answer()
            rested.append(True)

    controller.set_break_key(answer)
    program(tmp_path, "G0 X0.5\nM0\nG0 X1\nM2\n").start(controller)
    assert controller.run() is Status.OK, controller.state().message
    assert rested
    assert controller.state().position_mm == (1, 0, 0)
    made.close()


def test_who_braked_for_a_late_record_goes_on_only_when_the_record_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Given no time for a second meanwhile, it said "at rest", with blocks in the queue."""
    made = assemble(configured(), state=tmp_path, clock="paced")
    controller, recorder = made.controller, made.recorder
    assert isinstance(recorder, JournalRecorder)
    runner, driver = controller._loop.runner, controller._loop._driver
    resume, said_moving = driver.resume, []

    def resumed() -> None:
        said_moving.append(kept(tmp_path)["motion"] is not None)
        resume()

    def brake() -> None:
        if controller._queue.report.running and not runner._brakes_for_record and not said_moving:
            runner._brakes_for_record = True
            driver.brake()
            while driver.poll(0.02).running:
                pass
            controller._queue.poll()
            recorder._say_resting()
            recorder.wait(5)
            assert kept(tmp_path)["motion"] is None

    monkeypatch.setattr(driver, "resume", resumed)
    controller.set_break_key(brake)
    controller.jog("x", 4)
    assert controller.run() is Status.OK, controller.state().message
    assert said_moving
    assert all(said_moving)
    assert controller.state().position_mm[0] == 4
    made.close()
