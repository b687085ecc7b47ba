"""Drawings: whatever is in a file, it becomes paths or one sentence."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.engrave.drawing import Picture
from fraese.engrave.hpgl.commands import PASSED, ROWS
from fraese.engrave.job import Job
from fraese.engrave.program import lines, moves
from fraese.engrave.sources import read
from fraese.engrave.tools import Cutter, Laser
from fraese.engrave.ways import planned
from tests.engrave.drawings import EVERY
from tests.fuzz.lengths import fuzzed, is_a_sentence, refusal_of

_NUMBERS = st.lists(
    st.one_of(
        st.integers(-3000, 3000).map(str),
        st.sampled_from(["1e9", "99999999999", "-0.5", ".5", "+3", "0", "-", "1.2.3", "9" * 400]),
    ),
    max_size=9,
).map(",".join)
_NAMES = st.sampled_from(
    [*ROWS, *list(PASSED)[:6], "LB", "PE", "SM", "DT", "QQ", "\x1b.I;:", "P", ""]
)
_COMMANDS = st.lists(
    st.tuples(_NAMES, _NUMBERS, st.sampled_from([";", "", "\n", "\x03", "\xff", " "])).map("".join),
    max_size=25,
).map(lambda parts: ("IN;" + "".join(parts)).encode("latin-1", "replace"))


def engraved(file: Path) -> None:
    """All the way, with little memory and time."""
    source = read(file)
    way = "bitmap" if isinstance(source, Picture) else "outline"
    job = Job(way=way, width_mm=20, tolerance_mm=0.1, distance_mm=0.5)
    plan = planned(source, job, file.name)
    for tool in (Cutter(), Laser(power=100)):
        each = list(plan.strokes.each)
        again = plan.strokes._replace(each=each)
        assert all(lines(["x"], tool, moves(tool, again, job)))
        plan = plan._replace(strokes=again)


def sentence(folder: Path, name: str, data: bytes) -> str:
    file = folder / name
    file.write_bytes(data)
    said = refusal_of(lambda: engraved(file))
    assert is_a_sentence(said)
    return said


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("drawings")


@given(data=_COMMANDS)
@fuzzed(150)
def test_any_commands_of_a_plotter(folder: Path, data: bytes) -> None:
    sentence(folder, "any.plt", data)


@given(data=st.binary(max_size=300))
@fuzzed(100)
def test_any_bytes_behind_the_beginning_of_a_plotter_file(folder: Path, data: bytes) -> None:
    sentence(folder, "any.plt", b"IN;SP1;" + data)


@given(
    name=st.sampled_from(sorted(EVERY)),
    place=st.integers(0, 100_000),
    garbage=st.binary(min_size=0, max_size=8),
    cut=st.booleans(),
)
@fuzzed(150)
def test_files_that_are_damaged(
    folder: Path, name: str, place: int, garbage: bytes, cut: bool
) -> None:
    whole = EVERY[name]
    at = place % len(whole)
    rest = b"" if cut else whole[at + len(garbage) :]
    sentence(folder, name, whole[:at] + garbage + rest)


@pytest.mark.parametrize(
    "inside",
    [
        '<g id="a"><use href="#a"/></g>',
        '<path d="M 0 0 L"/><rect width="10" height="10"/>',
        '<path d="M nan nan L 1e400 3 Z"/>',
        '<rect width="1e300" height="3"/>',
        '<circle r="-3"/>',
        '<path d="M0 0 A 0 0 0 0 0 0 0 A 1e-9 5 3 0 1 3 3"/>',
        '<g transform="scale(0)"><rect width="10" height="10"/></g>',
        '<g transform="matrix(bad)"><rect width="10" height="10"/></g>',
        "<!-- nothing -->",
        "".join(f'<g id="g{n}">{f"""<use href="#g{n - 1}"/>""" * 10}</g>' for n in range(12)),
        "<g>" * 300 + "</g>" * 300,
    ],
)
def test_drawings_that_mean_no_good(folder: Path, inside: str) -> None:
    head = '<svg xmlns="http://www.w3.org/2000/svg" width="40mm" height="30mm" viewBox="0 0 40 30">'
    sentence(folder, "bad.svg", f"{head}{inside}</svg>".encode())
