"""Program files: looked through, refused or run; where the carriages are is the truth."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from fraese.assembly import Plant
from fraese.control.state import Status
from fraese.gcode import canon
from fraese.gcode.text import MAX_LINE
from fraese.program import source as program_source
from fraese.program.program import Program, open_program
from fraese.program.translate import Moves
from tests.fuzz.lengths import fuzzed, is_a_sentence, refusal_of, soon
from tests.fuzz.test_language import PROGRAMS
from tests.helpers import carriages, homed, look

#: Behind so many moves a program counts as ended: most loops of these have no end.
_MOST_MOVES = 60
_NEAR = st.decimals(-3, 3, places=3).map(str)
_LINES = st.one_of(
    st.builds("G1 X{} Y{} F{}".format, _NEAR, _NEAR, st.sampled_from([1e-9, 1, 700, 1e9, 1e39])),
    st.builds("G0 X{} Z{}".format, _NEAR, _NEAR),
    st.builds("G2 X{} Y{} R{} F500".format, _NEAR, _NEAR, _NEAR),
    st.builds("G3 X{} Y{} I{} J{} F500".format, _NEAR, _NEAR, _NEAR, _NEAR),
    st.builds("G81 X{} Y{} Z{} R1 F300".format, _NEAR, _NEAR, _NEAR),
    st.builds("G92 X{}".format, _NEAR),
    st.builds("G10 L2 P1 X{} R{}".format, _NEAR, _NEAR),
    st.builds("#1=[{}/{}]".format, _NEAR, _NEAR),
    st.sampled_from(
        [
            "G91",
            "G90",
            "G20",
            "G21",
            "G17",
            "G18",
            "G61",
            "G64",
            "G64 P0.1",
            "G64 P1e9",
            "G4 P0.01",
            "G4 P1e-30",
            "G93",
            "G94",
            "G80",
            "M3 S1",
            "M5",
            "M7",
            "M9",
            "M0",
            "M6 T1",
            "G43 H1",
            "G49",
            "G28",
            "G92.1",
            "X#1",
            "o1 while [#1 lt 3]",
            "o1 endwhile",
            "o2 repeat [5]",
            "o2 endrepeat",
            "o3 sub",
            "o3 endsub",
            "o3 call",
            "M98 P4",
            "O4",
            "M99",
            "M2",
            "%",
            "G38.2 X3 F100",
            "(msg,a)",
            "$",
            "\x00",
            "é",
        ]
    ),
)
TEXTS = st.one_of(
    st.lists(_LINES, max_size=25).map(lambda lines: "\n".join(["G21 G90 F600", *lines])), PROGRAMS
)


@pytest.fixture(autouse=True)
def _ends(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every program ends behind so many moves."""
    real: Callable[..., Moves] = program_source.ProgramSource.moves

    def cut(source: program_source.ProgramSource, *given: Any) -> Moves:
        moves, facts = real(source, *given), None
        for _ in range(_MOST_MOVES):
            try:
                move = moves.send(facts)
            except StopIteration:
                return
            facts = yield move
        yield canon.End(source.lines_read)

    monkeypatch.setattr(program_source.ProgramSource, "moves", cut)


def run(made: Plant, path: Path) -> None:
    """Refused, and nothing has moved; or run, and the carriages are where it says."""
    controller, before = made.controller, carriages(made)
    opened: list[Program] = []
    refusal = refusal_of(lambda: opened.append(open_program(path)))
    if not opened:
        assert is_a_sentence(refusal)
        return
    part = opened[0]
    controller.set_break_key(lambda: controller.answer() if controller.question else None)
    refusal = refusal_of(lambda: part.check(controller))
    assert is_a_sentence(refusal)
    looked = part._looked
    if looked is None:
        assert refusal
        assert carriages(made) == before
        return
    facts = looked[1]
    if facts.duration_s > 600:
        return
    with soon(60):
        part.start(controller, facts)
        status = controller.run()
    state = controller.state()
    assert status in (Status.OK, Status.ERROR), state.message
    moved = tuple(now - then for now, then in zip(carriages(made), before, strict=True))
    assert moved == state.position_steps
    assert look(made).lost_steps == (0, 0, 0)


def test_texts(tmp_path: Path) -> None:
    path = tmp_path / "part.ngc"

    @fuzzed(60)
    @given(TEXTS)
    @example("G1 X1 F1e-30")
    @example("(" + "x" * (MAX_LINE + 1))
    def check(text: str) -> None:
        path.write_bytes(text.encode(errors="replace"))
        run(homed(), path)

    check()


def test_lists(tmp_path: Path) -> None:
    path = tmp_path / "list"
    cells = st.one_of(_NEAR, st.sampled_from(["", "1e-320", "x", "9" * 5000, "1e39", "-0", "nan"]))
    rows = st.lists(cells, max_size=5).map(" ".join)
    heads = st.sampled_from(["", "x y z feed\n", "# unit: inch\n", "x;y\n", "feed\n"])

    @fuzzed(40)
    @given(heads, st.lists(rows, max_size=8))
    @example("", ["0 0 0 1e-320", "1 1 1"])
    @example("", ["1e39"])
    def check(head: str, lines: list[str]) -> None:
        path.write_text(head + "\n".join(lines))
        run(homed(), path)

    check()


def test_damaged_files(tmp_path: Path) -> None:
    """A program with some bytes changed, cut out or put in."""
    path = tmp_path / "part.ngc"
    whole = b"G21 G90 F600\n#<a>=2\nG1 X[#<a>*1.5] Y1\nG2 X1 Y2 I-1 J0.5\no1 repeat [2]\nG91 X.1\n"
    whole += b"o1 endrepeat\nG90 G0 Z-1 (down)\nM2\n"
    places = st.integers(0, len(whole))

    @fuzzed(60)
    @given(places, places, st.binary(max_size=4))
    def check(first: int, last: int, put: bytes) -> None:
        path.write_bytes(whole[:first] + put + whole[last:])
        run(homed(), path)

    check()


def test_any_bytes_as_a_file(tmp_path: Path) -> None:
    path = tmp_path / "part"

    @fuzzed(60)
    @given(st.binary(max_size=400))
    def check(data: bytes) -> None:
        path.write_bytes(data)
        run(homed(), path)

    check()


def test_any_name(tmp_path: Path) -> None:
    @fuzzed(100)
    @given(st.text(max_size=300))
    @example("a" * 5000)
    @example("\0")
    @example("\ud800")
    def check(name: str) -> None:
        # What the name itself contains is made harmless where it is shown.
        assert len(refusal_of(lambda: open_program(tmp_path / name))) < 1000

    check()
