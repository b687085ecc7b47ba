"""Overrides and switches of a run: soon, on everything that moves, and on nothing else."""

from collections.abc import Callable
from pathlib import Path

import pytest

from fraese.assembly import Plant
from fraese.control.handling import Handling
from fraese.control.state import MachineState, Status
from fraese.errors import LimitError
from tests.helpers import axes, homed, program, run_program

#: A change is felt within this time.
FELT_S = 0.3


def watched(
    made: Plant, text: str, folder: Path, act: Callable[[Plant, MachineState], object]
) -> list[tuple[float, MachineState]]:
    """Run it; (time, state) after every slice, ``act`` being called at each."""
    seen: list[tuple[float, MachineState]] = []

    def look() -> None:
        state = made.controller.state()
        seen.append((made.clock.now_ns() / 1e9, state))
        act(made, state)

    made.controller.set_break_key(look)
    assert run_program(made, program(folder, text)) is Status.OK
    return seen


def quick() -> Plant:
    """A machine that looks as often as one in real time does."""
    made = homed()
    made.controller._loop.runner._slice_s = 0.02
    return made


def felt_after_s(
    folder: Path, text: str, change: Callable[[Handling], object], *, faster: bool
) -> float:
    """How long after a change in full motion the speed begins to follow."""
    made = quick()
    at: list[tuple[float, float]] = []

    def act(made: Plant, state: MachineState) -> None:
        if not at and state.job is not None and state.job.elapsed_s > 1.5:
            at.append((made.clock.now_ns() / 1e9, state.speed_mm_min))
            change(made.controller.handling)

    seen = watched(made, text, folder, act)
    then_s, speed = at[0]
    assert speed > 100
    return next(
        time_s - then_s
        for time_s, state in seen
        if time_s > then_s
        and (state.speed_mm_min > speed * 1.02 if faster else state.speed_mm_min < speed * 0.98)
    )


@pytest.mark.parametrize("feed", [120, 300, 600, 900])
def test_a_feed_override_is_felt_soon_either_way(tmp_path: Path, feed: int) -> None:
    text = f"G1 X60 F{feed}\nM2\n"
    raised = felt_after_s(tmp_path, text, lambda h: h.set_feed(1.2), faster=True)
    lowered = felt_after_s(tmp_path, text, lambda h: h.set_feed(0.5), faster=False)
    assert raised <= FELT_S
    assert lowered <= 0.1


def test_an_override_of_rapids_is_felt_soon_and_leaves_feeds_alone(tmp_path: Path) -> None:
    lowered = felt_after_s(tmp_path, "G0 X250\nM2\n", lambda h: h.set_rapid(0.5), faster=False)
    assert lowered <= 0.1

    def longest(text: str, rapid: float, feed: float) -> float:
        made = homed()
        made.controller.handling.set_rapid(rapid)
        made.controller.handling.set_feed(feed)
        seen = watched(made, text, tmp_path, lambda made, state: None)
        return max(state.speed_mm_min for _, state in seen)

    assert longest("G0 X100\nM2\n", 0.5, 1) == pytest.approx(600, rel=0.02)
    assert longest("G0 X100\nM2\n", 1, 0.5) == pytest.approx(1200, rel=0.02)
    assert longest("G1 X40 F600\nM2\n", 0.2, 1) == pytest.approx(600, rel=0.02)


def test_a_raised_rapid_is_felt_soon(tmp_path: Path) -> None:
    made = quick()
    made.controller.handling.set_rapid(0.4)
    at: list[tuple[float, float]] = []

    def act(made: Plant, state: MachineState) -> None:
        if not at and state.job is not None and state.job.elapsed_s > 1.5:
            at.append((made.clock.now_ns() / 1e9, state.speed_mm_min))
            made.controller.handling.set_rapid(1.0)

    seen = watched(made, "G0 X250\nM2\n", tmp_path, act)
    then_s, speed = at[0]
    after_s = next(t - then_s for t, s in seen if t > then_s and s.speed_mm_min > speed * 1.02)
    assert after_s <= FELT_S


def test_a_lowered_feed_does_not_slow_the_rapid_that_follows(tmp_path: Path) -> None:
    """In the queue lie both; only the feed is slowed."""
    made = quick()

    def act(made: Plant, state: MachineState) -> None:
        if state.job is not None and state.job.line == 1 and state.work_mm[0] > 19:
            made.controller.handling.set_feed(0.3)

    seen = watched(made, "G1 X20 F600\nG0 X80\nM2\n", tmp_path, act)
    rapid = [state.speed_mm_min for _, state in seen if state.job and state.job.line == 2]
    assert max(rapid) == pytest.approx(1200, rel=0.02)


def test_no_step_is_lost_while_overrides_go_up_and_down(tmp_path: Path) -> None:
    made = homed(axes=axes(max_rate_hz=4000, acceleration_hz_s=20_000))
    factors = [0.1, 2.0, 0.5, 1.0, 1.7]
    count = 0

    def act(made: Plant, state: MachineState) -> None:
        nonlocal count
        count += 1
        if not count % 7:
            made.controller.handling.set_feed(factors[count // 7 % 5])
            made.controller.handling.set_rapid(min(1.0, factors[count // 7 % 5]))

    watched(made, "G1 X20 F600\nG0 X60 Y30\nG1 Y10\nX20\nG0 X0 Y0\nM2\n", tmp_path, act)
    state = made.controller.state()
    assert state.position_mm[:2] == (0, 0)
    assert state.lost_steps == (0, 0, 0)


@pytest.mark.parametrize("factor", [0.09, 1.01, float("nan")])
def test_an_override_of_rapids_is_10_to_100_per_cent(factor: float) -> None:
    with pytest.raises(LimitError, match="rapid override is 10 to 100 %"):
        homed().controller.handling.set_rapid(factor)


# --- switches of a run ---------------------------------------------------------------------------


def questions(made: Plant, text: str, folder: Path) -> list[str]:
    """What was asked; each is answered."""
    asked: list[str] = []

    def act(made: Plant, state: MachineState) -> None:
        if state.question:
            asked.append(state.question)
            assert not state.running
            made.controller.answer()

    watched(made, text, folder, act)
    return asked


def test_single_block_waits_behind_every_line_that_moves(tmp_path: Path) -> None:
    text = "G21\nG1 X5 F600\n(nothing)\nX10\nG4 P0.1\nG2 X12 Y2 R5\nM2\n"
    made = homed()
    assert questions(made, text, tmp_path) == []
    made.controller.handling.switch("single_block")
    asked = questions(made, text, tmp_path)
    assert [question.split(":")[1] for question in asked] == [
        " line 4 comes next.",
        " line 6 comes next.",
    ]


def test_m1_and_the_slash_act_as_they_are_switched(tmp_path: Path) -> None:
    made = homed()
    text = "G1 X5 F600\nM1\n/ X10\nM2\n"
    assert questions(made, text, tmp_path) == []
    assert made.controller.state().work_mm[0] == 10
    made.controller.handling.switch("optional_stop")
    made.controller.handling.switch("block_delete")
    assert len(questions(made, "G0 X0\n" + text, tmp_path)) == 1
    assert made.controller.state().work_mm[0] == 5


# --- progress ------------------------------------------------------------------------------------


def test_progress_comes_from_the_plan_with_the_override_in_it(tmp_path: Path) -> None:
    made = homed()
    text = "G1 X10 F120\nG0 X0\nG1 X10\nM2\n"
    seen = watched(made, text, tmp_path, lambda made, state: None)
    jobs = [(time_s, state.job) for time_s, state in seen if state.job and state.job.share]
    end_s = jobs[-1][0]
    shares = [job.share for _, job in jobs if job.share]
    assert shares == sorted(shares)
    assert shares[-1] > 0.99
    for time_s, job in jobs[10:]:
        assert job.left_s == pytest.approx(end_s - time_s, abs=0.15)
    made.controller.handling.set_feed(0.5)
    seen = watched(made, "G0 X0\n" + text, tmp_path, lambda made, state: None)
    half_way = seen[len(seen) // 2]
    assert half_way[1].job is not None
    assert half_way[1].job.left_s == pytest.approx(seen[-1][0] - half_way[0], abs=0.3)


def test_what_is_waited_does_not_count(tmp_path: Path) -> None:
    made = homed()
    waited = 0

    def act(made: Plant, state: MachineState) -> None:
        nonlocal waited
        if state.question:
            waited += 1
            if waited > 500:
                made.controller.answer()

    watched(made, "G1 X5 F600\nM0\nX10\nM2\n", tmp_path, act)
    job = made.controller.state().job
    assert job is not None
    assert job.elapsed_s == pytest.approx(1.0, abs=0.3)


def test_the_line_of_the_job_before_is_not_told(tmp_path: Path) -> None:
    made = homed()
    watched(made, "G21\n" * 30 + "G1 X5 F600\nM2\n", tmp_path, lambda made, state: None)
    lines: list[int] = []
    made.controller.set_display(
        lambda: lines.append(job.line if (job := made.controller.state().job) else 0)
    )
    watched(made, "G1 X0 F600\nM2\n", tmp_path, lambda made, state: None)
    assert lines[0] == 0
    assert max(lines) <= 2
