import re
import time

import pytest

from fraese.errors import ProgramError
from tests.gcode.run import moves


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("g0 a5", "no axis A"),
        ("g41 d1", "G41 needs the diameter of a tool, and there is no tool table"),
        ("g33 z1 k1", "G33 is refused"),
        ("g76", "G76 is refused"),
        ("g95", "G95 is refused"),
        ("g96 s1", "G96 is refused"),
        ("g5.1 x1", "G5.1 is refused"),
        ("g7", "G7 is refused"),
        ("m3 s9 f9 | g84 z-1 r1 p-1", "must not be negative"),
        ("m3 s9 f9 | g74 z-1 r1", "needs a spindle that turns by M4"),
        ("if [#1 lt 2] goto 10", "IF, WHILE, GOTO and END are not known without O"),
        ("while [#1 lt 2] do1", "IF, WHILE, GOTO and END are not known without O"),
        ("$H", "a command to grbl"),
        ("$$", "a command to grbl"),
        ("m98 p1 x5 | m2 | o1 | m99", "M98 takes P, the number, and L"),
        ("m98 p1 | m2 | o1 | g0 x1", "O1 ends without M99"),
        ("m62 p1", "M62 is refused"),
        ("m19", "M19 is refused"),
        ("g999", "G999 is not a known code"),
        ("m100", "M100 is a user's own code"),
        ("g1 x1", "G1 needs a feed"),
        ("g2 x10 i4 f1", "does not close"),
        ("g2 x10 r4 f1", "too small"),
        ("x1", "need a motion code"),
        ("g0 x[1/0]", "division by zero"),
        ("g0 xacos[2]", "acos of 2"),
        ("g0 x[1e999]", "not an operator"),
        ("g0 x" + "9" * 50, "too large"),
        ("g0 x[10**39*10**39]", "too large"),
        ("g0 x[2**9999]", "too large"),
        ("o1 sub | o1 call | o1 endsub | o1 call", "deep"),
        ("o1 while [1] | o1 endwhile", "never ends"),
        ("o1 do | o1 while [1]", "never ends"),
        ("o1 repeat [1000000000] | #1=1 | o1 endrepeat", "never ends"),
        ("o1 while [0]", "no endwhile before the end"),
        ("o1 sub", "no endsub before the end"),
        ("o1 call", "no such subroutine"),
        ("g0 x\0", "cannot be used here|number is missing|neither a number"),
        ("g0 x1\0", "cannot be used here"),
        ("g0 x1" + " " * 5000, "longer than 4096"),
        ("(" * 2, "not closed"),
        ("g0 x" + "[" * 500, "deep"),
        ("g0 x" + "#" * 500 + "1", "deep"),
        ("g0 x" + "sin[" * 500, "deep"),
        ("g83 x1 z-1 r1 q.0000001 f1", "pecks"),
        ("g2 i1 p1000000 f1", "turns"),
    ],
)
def test_refused_with_line_and_reason(text: str, said: str) -> None:
    start = time.monotonic()
    with pytest.raises(ProgramError, match=said) as caught:
        moves("g21|" + text, max_idle_lines=20_000, file="part.ngc")
    assert caught.value.line >= 2
    assert re.match(
        rf"part\.ngc, line {caught.value.line}( \(called in line [^:]*\))?: ", str(caught.value)
    )
    assert time.monotonic() - start < 5


def test_a_loop_that_moves_may_go_on_for_ever() -> None:
    text = "o1 repeat [5000] | g91 g0 x1 | o1 endrepeat"
    assert len(moves(text, max_idle_lines=10)) == 5001


@pytest.mark.parametrize("body", ["g0 x1", "(print,still here)", "g4 p1", "f100", "m8"])
def test_a_loop_that_gets_nowhere_ends(body: str) -> None:
    with pytest.raises(ProgramError, match="never ends"):
        moves(f"o1 while [1] | {body} | o1 endwhile", max_idle_lines=2_000)
