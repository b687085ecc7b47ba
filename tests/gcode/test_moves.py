import itertools
import tracemalloc
from collections import deque
from collections.abc import Iterator

import pytest

from fraese.errors import ProgramError
from fraese.gcode.canon import (
    Arc,
    Coolant,
    Dwell,
    End,
    Facts,
    Feed,
    Message,
    Offsets,
    Overrides,
    PathControl,
    PathMode,
    Pause,
    Probe,
    Rapid,
    Spindle,
    Tool,
)
from fraese.gcode.interpreter import Interpreter, interpret
from fraese.gcode.setup import Setup
from fraese.tooldata import ToolData
from tests.gcode.run import answered, marked, moves


def test_positions_are_machine_millimetres() -> None:
    assert moves("g20 g10 l2 p1 x1 | g0 x1 | g1 y1 f10", position_mm=(0, 0, 5)) == [
        Rapid(2, (50.8, 0, 5)),
        Feed(3, (50.8, 25.4, 5), 254),
        End(3),
    ]


@pytest.mark.parametrize(
    "change", ["g55", "g10 l2 p1 x1", "g10 l2 p1 r30", "g92 x3", "#5221 = 4", "t2 m6", "m61 q2"]
)
def test_a_change_of_offsets_is_told_before_the_next_move(change: str) -> None:
    told = marked(f"g0 x1 | x2 | {change} | #100 = 7 | g0 z3 | x4 | m2")
    at = next(number for number, move in enumerate(told) if isinstance(move, Offsets))
    assert [move for move in told[:at] if isinstance(move, Rapid)][-1] == Rapid(2, (2, 0, 0))
    assert told[at + 1].line == 5
    # The end of a program gives back what it has changed.
    rest = [move for move in told[at + 1 :] if isinstance(move, Offsets)]
    assert rest == ([Offsets(7)] if change == "g55" else [])


def test_feed_in_front_of_units_on_one_line_counts_in_the_old_ones() -> None:
    assert moves("g20 f10 g1 x1")[0] == Feed(1, (25.4, 0, 0), 10)


def test_inverse_time_becomes_a_feed() -> None:
    assert moves("g93 | g1 x3 y4 f2")[0] == Feed(2, (3, 4, 0), 10)


@pytest.mark.parametrize(
    ("text", "arc"),
    [
        ("g2 x10 i5 f1", Arc(1, (10, 0, 0), (5, 0), 17, -1, 1)),
        ("g3 i5 f1 p2", Arc(1, (0, 0, 0), (5, 0), 17, 2, 1)),
        ("g18 g3 x0 z10 k5 y1 f1", Arc(1, (0, 1, 10), (5, 0), 18, 1, 1)),
        ("g19 g2 y10 j5 f1", Arc(1, (0, 10, 0), (5, 0), 19, -1, 1)),
    ],
)
def test_arcs_have_their_centre_in_the_order_of_the_plane(text: str, arc: Arc) -> None:
    assert moves(text)[0] == arc


def test_everything_else_that_a_program_can_say() -> None:
    assert moves("m3 s100|m8|m49|g61|g4 p.5|(msg,hi)|t3 m6|m0|m1|m2") == [
        Spindle(1, 1, 100),
        Coolant(2, False, True),
        Overrides(3, False),
        PathControl(4, PathMode.EXACT_PATH, 0),
        Dwell(5, 0.5),
        Message(6, "hi", "msg"),
        Spindle(7, 0, 100),
        Tool(7, 3),
        Pause(8, False),
        Pause(9, True),
        Overrides(10, True),
        Coolant(10, False, False),
        End(10),
    ]


@pytest.mark.parametrize("text", ["g0 x1", "% | g0 x1 | % | g0 x2", "g0 x1 | m2 | g0 x2"])
def test_a_program_ends_once(text: str) -> None:
    assert [type(move) for move in moves(text)] == [Rapid, End]


def test_a_tap_goes_along_the_axis_of_its_plane() -> None:
    assert [
        move.to
        for move in moves("g18 m3 s9 f9 g0 y5 | g84 x7 y-1 z8 r1")
        if isinstance(move, Rapid | Feed)
    ] == [(0, 5, 0), (7, 5, 8), (7, 1, 8), (7, -1, 8), (7, 1, 8)]


def test_a_tap_lets_no_override_slip_in() -> None:
    tapping = moves("m3 s9 f9 g0 z1 | g84 x1 z-1 r1")
    assert [move.enabled for move in tapping if isinstance(move, Overrides)] == [False, True]
    assert [move.direction for move in tapping if isinstance(move, Spindle)] == [1, -1, 1, 0]


def test_many_subprograms_behind_the_program_are_looked_for_once() -> None:
    numbers = range(1, 1201)
    calls = [f"m98 p{n} | o<s{n}> call" for n in numbers]
    bodies = [f"o{n} | g0 x{n} | m99 | o<s{n}> sub | g0 y{n} | o<s{n}> endsub" for n in numbers]
    ends = moves("|".join((*calls, "m30", *reversed(bodies))))
    assert [move.to[:2] for move in ends if isinstance(move, Rapid)][-2:] == [
        (1200, 1199),
        (1200, 1200),
    ]


def test_subprograms_that_run_into_each_other_are_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fraese.gcode.subroutines.MAX_NUMBERED", 10_000)
    numbers = range(1, 30)
    lines = [f"m98 p{n}" for n in numbers]
    lines += ["m30", *(f"o{n}" for n in numbers), *["(nothing)"] * 600, "m99"]
    with pytest.raises(ProgramError, match="too long without M99"):
        moves("|".join(lines))


def test_no_line_is_read_before_it_is_needed() -> None:
    read = 0

    def lines() -> Iterator[str]:
        nonlocal read
        for read in range(1, 100):
            yield f"g0 x{read}"

    run = interpret(lines())
    for count in range(1, 5):
        next(run)
        assert read == count


def test_memory_does_not_grow_with_length() -> None:
    lines = (f"g1 x{i % 100} y{i % 7} f100" for i in itertools.count())
    run = interpret(itertools.islice(lines, 30_000))
    deque(itertools.islice(run, 1_000), 0)
    tracemalloc.start()
    deque(run, 0)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 200_000


def test_a_finished_loop_is_forgotten() -> None:
    lines = itertools.chain(
        ["o1 repeat [3]", "g91 g0 x1", "o1 endrepeat"],
        (f"g0 x{i % 9}" for i in range(30_000)),
    )
    tracemalloc.start()
    deque(interpret(lines), 0)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 300_000


# Barriers


def test_a_probe_that_touches_sets_its_parameters() -> None:
    facts = Facts((3.2, 0, 0), touched=True, contact_mm=(3, 0, 0))
    result, _ = answered("g38.2 x5 f10 | g0 x[#5061+1] | (debug,#5070) | g91 g0 x1", facts)
    assert result == [
        Probe(1, (5, 0, 0), 10, True, True),
        Rapid(2, (4, 0, 0)),
        Message(3, "1.000000", "debug"),
        Rapid(4, (5, 0, 0)),
        End(4),
    ]


def test_behind_a_probe_the_position_is_where_the_machine_stopped() -> None:
    facts = Facts((3.2, 0, 0), touched=True)
    result, _ = answered("g38.2 x5 f10 | g91 g0 x1", facts)
    assert result[1] == Rapid(2, (4.2, 0, 0))


@pytest.mark.parametrize(("code", "touched"), [("g38.2", 1), ("g38.3", 0), ("g38.5", 0)])
def test_without_answer_a_probe_goes_to_its_target(code: str, touched: int) -> None:
    result = moves(f"{code} x5 f10 | g0 y[#5061+#5070]")
    assert result[1] == Rapid(2, (5, 5 + touched, 0))


def test_a_probe_that_must_touch_and_does_not_is_refused() -> None:
    with pytest.raises(ProgramError, match=r"line 1: .* did not touch"):
        answered("g38.2 x5 f10", Facts((5, 0, 0)))


def test_a_probe_that_may_miss_goes_on() -> None:
    result, _ = answered("g38.3 x5 f10 | g0 x#5070", Facts((5, 0, 0)))
    assert result[1] == Rapid(2, (0, 0, 0))


def test_contact_is_told_in_the_programs_coordinates() -> None:
    facts = Facts((25.4, 0, 0), touched=True)
    result, _ = answered("g10 l2 p1 x12.7 | g20 | g38.2 x5 f10 | (print,%.2f#5061)", facts)
    assert result[1] == Message(4, "0.50", "print")


@pytest.mark.parametrize("barrier", ["m0", "m1", "t1 m6"])
def test_the_machine_may_have_been_moved_while_it_waited(barrier: str) -> None:
    result, _ = answered(f"{barrier} | g91 g0 x1", Facts((7, 8, 9)))
    assert result[1] == Rapid(2, (8, 8, 9))


def test_a_motion_behind_a_tool_change_on_its_line_starts_where_the_change_ended() -> None:
    result, _ = answered("g91 t1 m6 g0 x1", Facts((7, 8, 9)))
    assert result[1] == Rapid(1, (8, 8, 9))


# State


def test_changed_parameters_can_be_kept() -> None:
    _, interpreter = answered("g55 | g10 l2 p2 x3 | g92 y4 | g28.1")
    kept = interpreter.parameters.persistent()
    assert kept[5220] == 1
    assert kept[5241] == 3
    assert (kept[5210], kept[5212]) == (1, -4)
    again = moves("g55 g0 x0 y0", parameters=kept)
    assert again[0] == Rapid(1, (3, -4, 0))


def test_tool_lengths_come_from_the_table() -> None:
    tools = {1: ToolData(10), 2: ToolData(20, 6)}
    assert moves("t2 m6 g43 | g0 z0 | g43 h1 | z0", tools=tools)[1:3] == [
        Rapid(2, (0, 0, 20)),
        Rapid(4, (0, 0, 10)),
    ]
    with pytest.raises(ProgramError, match="tool 3 is not in the tool table"):
        moves("g43 h3", tools=tools)


def test_without_a_table_every_tool_has_no_length() -> None:
    assert moves("t99 m6 g43 h7 | g0 z1")[1] == Rapid(2, (0, 0, 1))


def test_what_is_in_force_in_the_middle() -> None:
    interpreter = Interpreter(Setup(position_mm=(1, 2, 3)))
    run = interpreter.run(["g20 g91 f10 m3 s500", "g55 g18 g1 x1", "m8", "g0 z1", "g21 f7"])
    while next(run).line < 4:
        pass
    modal = interpreter.modal
    assert (modal.motion, modal.plane, modal.scale_mm) == (0, 18, 25.4)
    assert (modal.absolute, interpreter.frame.system, modal.spindle) == (False, 2, 1)
    assert (modal.feed_mm_min, modal.rev_min, modal.flood) == (10, 500, True)


def test_block_delete() -> None:
    text = "/g0 x1 | /o1 if [0] | g0 x2 | /o1 endif"
    assert [move.line for move in moves(text, block_delete=True)] == [3, 4]
    assert [move.line for move in moves(text)] == [1, 4]
