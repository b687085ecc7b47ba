"""Whatever a sender says: every line is answered, nothing else comes out, it stays inside."""

from hypothesis import given
from hypothesis import strategies as st

from tests.fuzz.lengths import fuzzed, soon
from tests.serve.sender import Bench, bench

_WORDS = st.sampled_from(
    [
        "G0", "G1", "G2", "G3", "G4", "G10", "G20", "G21", "G28", "G38.2", "G38.3", "G43", "G53",
        "G54", "G55", "G80", "G81", "G90", "G91", "G92", "G93", "G999", "M0", "M3", "M5", "M6",
        "M30", "S100", "T1", "F300", "F0", "X1", "X-1", "X1e3", "Y2", "Z-1", "A1", "I1", "J0", "R2",
        "P0.01", "P1", "L20", "N7", "/", "%", "#1=2", "X#1", "[1/0]", "(", ")", ";", "(MSG,a)",
        "O100", "M98", "G41", "$", "$$", "$#", "$G", "$I", "$N", "$X", "$H", "$C", "$J=", "$10=",
        "$13=1", "$110=600", "$N0=", "$RST=$", "=", "1", "\t", " ", "Ä",
    ]
)  # fmt: skip
_LINES = st.lists(_WORDS, max_size=6).map("".join) | st.text(max_size=300)
_AT_ONCE = st.sampled_from([bytes([b]) for b in (*b"?!~\x18", *range(0x80, 0xA2))])
_ANSWERS = ("ok", "error:")


def _answers(at: Bench) -> int:
    return sum(line.startswith(_ANSWERS) for line in at.heard)


def _answers_questions(at: Bench) -> None:
    def between() -> None:
        at.session.between()
        at.bytes(b"~")

    at.plant.controller.set_show_pos(between)


def _inside(at: Bench) -> None:
    state = at.controller.state()
    for mm, low, high in zip(state.position_mm, state.low_mm, state.high_mm, strict=True):
        assert low - 0.01 <= mm <= high + 0.01


@fuzzed(60)
@given(st.lists(_LINES, max_size=12))
def test_every_line_is_answered_once(lines: list[str]) -> None:
    at = bench()
    # Questions are answered, and what locks is unlocked.
    _answers_questions(at)
    for line in lines:
        said = line.encode("utf-8", "replace").translate(
            None, bytes([*b"?!~\x18\r\n", *range(128, 256)])
        )
        before = _answers(at)
        with soon():
            at.bytes(said + b"\n")
            at.work()
        if not any(word.startswith(("ALARM", "Grbl")) for word in at.heard):
            assert _answers(at) == before + 1, (line, at.heard)
        at.bytes(b"\x18")
        with soon():
            at.work()
            at.say("$X")
        at.heard.clear()
        _inside(at)


@fuzzed(60)
@given(st.lists(st.binary(max_size=60) | _AT_ONCE | _LINES.map(str.encode), max_size=25))
def test_nothing_that_is_said_brings_it_out_of_step(parts: list[bytes]) -> None:
    at = bench()
    _answers_questions(at)
    with soon():
        for part in parts:
            at.bytes(part)
            at.bytes(b"\n")
            at.work()
        at.bytes(b"\n~\x18")
        at.work()
        at.say("$X")
    _inside(at)
    with soon():
        assert at.say("$G")[-1] == "ok"
        assert at.say("G21 G90 G0 X1 Y1 Z-1")[-1] == "ok"
    assert at.at_mm == (1.0, 1.0, -1.0)
