"""Whatever a file holds: moves or a ProgramError with a line, nothing else, and soon."""

import math
from collections.abc import Iterable
from itertools import islice
from pathlib import Path

from hypothesis import given
from hypothesis import strategies as st

from fraese.errors import ProgramError
from fraese.gcode.canon import Arc, Feed, Move, Rapid
from fraese.gcode.coordlist import looks_like_points, read_points
from fraese.gcode.interpreter import interpret
from fraese.gcode.jsonl import as_dict
from fraese.gcode.setup import Setup
from tests.fuzz.lengths import fuzzed, soon
from tests.gcode.run import read_moves

WORDS = """
    g0 g1 g2 g3 g4 g10 l2 l20 p1 p0 g17 g18 g19 g20 g21 g28 g28.1 g30 g38.2 g38.5 g40 g43 g43.1 g49
    g53 g54 g55 g61 g64 g73 g80 g81 g82 g83 g85 g86 g89 g90 g91 g90.1 g91.1 g92 g92.1 g92.3 g93
    g94 g98 g99 m0 m1 m2 m3 m4 m5 m6 m7 m8 m9 m48 m49 m70 m72 m73 f100 f0 s5 t1 h1 x1 y2 z-3 x y-1.5
    i1 j2 k3 r1 r-2 q1 l3 @5 ^30 #1=1 #1=[#1+1] #<a>=2 #<_b>=[#<a>*3] x#1 x[#<a>] x[1/0] [ ] ( ) ;
    (msg,a) (debug,#1) (print,%d#<a>) o1 o2 sub endsub call return if elseif else endif while
    endwhile do repeat endrepeat break continue [1] [0] [#1lt3] % / n5 sin[30] atan[1]/[2]
    exists[#<a>] ** mod and 1e9 99999999999999999999999999999999999999999999 -- .
    \0 \ufeff é o<x> $0
"""
FRAGMENTS = st.sampled_from([*WORDS.split(), "\n", "\n", "\n", " "])
PROGRAMS = st.lists(FRAGMENTS, max_size=60).map("".join)


def _check(move: Move) -> None:
    assert move.line >= 1
    as_dict(move)
    if isinstance(move, Rapid | Feed | Arc):
        assert all(map(math.isfinite, move.to))
    if isinstance(move, Feed | Arc):
        assert 0 < move.feed_mm_min < math.inf


def _consume(moves: Iterable[Move]) -> None:
    """Only a ProgramError with a line may come out."""
    refusal = None
    try:
        with soon():
            for move in islice(moves, 500):
                _check(move)
    except ProgramError as error:
        refusal = error
    assert refusal is None or refusal.line >= 1
    assert len(str(refusal)) < 400


def _run(text: str) -> None:
    _consume(interpret(text.split("\n"), Setup(max_idle_lines=500)))


@fuzzed(300)
@given(PROGRAMS)
def test_fragments(text: str) -> None:
    _run(text)


@fuzzed(300)
@given(st.text(max_size=200))
def test_any_text(text: str) -> None:
    _run(text)


@fuzzed(300)
@given(st.text("ghxyz[]#<>()=0123456789.+-*/ onifwhile\n", max_size=200))
def test_near_code(text: str) -> None:
    _run(text)


@fuzzed(300)
@given(st.text("0123456789.,;+-eExyzfd# \t:\nunitch", max_size=200))
def test_points(text: str) -> None:
    lines = text.split("\n")
    looks_like_points(lines)
    _consume(read_points(lines, feed_mm_min=100))


def test_any_bytes(tmp_path: Path) -> None:
    path = tmp_path / "part"

    @fuzzed(200)
    @given(st.binary(max_size=300))
    def check(data: bytes) -> None:
        path.write_bytes(data)
        _consume(read_moves(path, Setup(max_idle_lines=100), feed_mm_min=100))

    check()
