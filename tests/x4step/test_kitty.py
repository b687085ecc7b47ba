"""Kitty's keyboard protocol: what terminals send, and a program in such a terminal."""

import os
import signal
import sys
import textwrap
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.x4step.decoder import Decoder, Held, Key, Stroke
from fraese.x4step.keyboard import MAKE_CODES
from fraese.x4step.kitty import ASK_DEVICE, ASK_FLAGS, POP, PUSH, Kitty
from tests.x4step.kittyterminal import (
    FUNCTIONAL,
    KEYS,
    PRESS,
    RELEASE,
    REPEAT,
    ROOT,
    KittyTerminal,
    Screen,
    encoded,
)

MS: Final = 1_000_000
PHASES: Final = {PRESS: "press", REPEAT: "repeat", RELEASE: "release"}


def kitty_decoder(layout: str = "us") -> Decoder:
    decoder = Decoder(layout)
    decoder.tells_releases = True
    return decoder


# --- what comes is what was pressed ---------------------------------------------------------------


@given(
    name=st.sampled_from(KEYS),
    event=st.sampled_from(list(PHASES)),
    modifiers=st.integers(0, 255),
    layout=st.sampled_from(["us", "de"]),
)
def test_what_is_encoded_is_decoded(name: str, event: int, modifiers: int, layout: str) -> None:
    """Every key, press, repeat and release, with any modifiers; the place is told."""
    place = name.lower() if name not in FUNCTIONAL else ""
    data = encoded(name, event, modifiers, place=place)
    strokes = kitty_decoder(layout).strokes(data, 0)
    assert [(stroke.key.code, stroke.phase) for stroke in strokes] == [
        (MAKE_CODES[name], PHASES[event])
    ]


strokes = st.tuples(st.sampled_from(KEYS), st.sampled_from(list(PHASES)), st.integers(0, 255))


@given(typed=st.lists(strokes, max_size=6), data=st.data())
def test_no_escape_comes_out_of_a_sequence_wherever_it_is_split(
    typed: list[tuple[str, int, int]], data: st.DataObject
) -> None:
    """In pieces that come at once or far apart; far apart never right behind an ESC."""
    whole = b"".join(encoded(*stroke) for stroke in typed)
    cuts = sorted(data.draw(st.sets(st.integers(1, max(1, len(whole) - 1)), max_size=8)))
    decoder, now_ns, codes = kitty_decoder(), 0, []
    for first, last in zip([0, *cuts], [*cuts, len(whole)], strict=True):
        piece = whole[first:last]
        codes += [stroke.key.code for stroke in decoder.strokes(piece, now_ns)]
        pause_ms = 1 if piece.endswith(b"\x1b") else data.draw(st.sampled_from([0, 10, 24, 400]))
        now_ns += pause_ms * MS
        codes += [stroke.key.code for stroke in decoder.strokes(b"", now_ns)]
    assert codes == [MAKE_CODES[name] for name, _, _ in typed]


plain = st.sampled_from(
    [b"\x1b[A", b"\x1b[D", b"\x1bOD", b"\x1bOP", b"\x1b[5~", b"\x1b[1;5C", b"\x1b[24~", b"\x1b[[A"]
)


@given(
    typed=st.lists(plain, max_size=6), cuts=st.sets(st.integers(1, 20)), pause_ms=st.integers(0, 24)
)
def test_no_escape_comes_out_of_a_plain_sequence_either(
    typed: list[bytes], cuts: set[int], pause_ms: int
) -> None:
    whole = b"".join(typed)
    decoder, now_ns, codes = Decoder("us"), 0, []
    ends = [cut for cut in sorted(cuts) if cut < len(whole)]
    for first, last in zip([0, *ends], [*ends, len(whole)], strict=True):
        codes += [key.code for key in decoder.take(whole[first:last], now_ns)]
        now_ns += pause_ms * MS
        codes += [key.code for key in decoder.take(b"", now_ns)]
    assert MAKE_CODES["ESC"] not in codes
    assert len(codes) == len(typed)


@given(data=st.binary(max_size=60))
def test_any_bytes_are_taken(data: bytes) -> None:
    for tells in (False, True):
        decoder = Decoder("us")
        decoder.tells_releases = tells
        for stroke in [*decoder.strokes(data, 0), *decoder.strokes(b"", 1000 * MS)]:
            assert 0 <= stroke.key.code < 128


#: As terminals send them: kitty leaves out what is 1; foot and ghostty write the event of a press
#: with modifiers; WezTerm always writes modifiers.
@pytest.mark.parametrize(
    ("data", "code", "phase", "text"),
    [(b"\x1b[27u", 1, "press", "\x1b"), (b"\x1b[27;1:3u", 1, "release", "\x1b"),
     (b"\x1b[27;1:1u", 1, "press", "\x1b"), (b"\x1b[27;129:1u", 1, "press", "\x1b"),
     (b"\x1b[97;;97u", 30, "press", "a"), (b"\x1b[97:65;2;65u", 30, "press", "A"),
     (b"\x1b[97;1:2;97u", 30, "repeat", "a"), (b"\x1b[97;1:3u", 30, "release", "a"),
     (b"\x1b[43::93;;43u", 27, "press", "+"), (b"\x1b[43::93;1:3u", 27, "release", "+"),
     (b"\x1b[122::121;;122u", 21, "press", "z"), (b"\x1b[228::39;;228u", 40, "press", "ä"),
     (b"\x1b[1089::99;;1089u", 46, "press", "с"), (b"\x1b[60::60;1:3u", 86, "release", "<"),
     (b"\x1b[D", 75, "press", "\0K"), (b"\x1b[1;1:3D", 75, "release", "\0K"),
     (b"\x1b[1;1:2D", 75, "repeat", "\0K"), (b"\x1b[3;1:3~", 83, "release", "\0S"),
     (b"\x1b[13;1:3~", 61, "release", "\0="), (b"\x1b[P", 59, "press", "\0;"),
     (b"\x1b[57400;129;49u", 79, "press", "1"), (b"\x1b[57424;1:3u", 79, "release", "\0O"),
     (b"\x1b[57414u", 28, "press", "\0\x1c"), (b"\x1b[57413;;43u", 78, "press", "+"),
     (b"\x1b[57441;2u", 42, "press", ""), (b"\x1b[57441;1:3u", 42, "release", ""),
     (b"\x1b[57449;1:3u", 56, "release", ""), (b"\x1b[13u", 28, "press", "\n"),
     (b"\x1b[9;1:3u", 15, "release", "\t"), (b"\x1b[32;;32u", 57, "press", " "),
     (b"\x1b[99;5u", 46, "press", "\x03"), (b"\x1b[1089::99;5u", 46, "press", "\x03"),
     (b"\x1b[57427;1:3~", 76, "release", "\0L"), (b"\x1b[57361u", 55, "press", "\x007")],
)  # fmt: skip
def test_what_terminals_send(data: bytes, code: int, phase: str, text: str) -> None:
    (stroke,) = kitty_decoder().strokes(data, 0)
    assert (stroke.key, stroke.phase) == (Key(code, text), phase)


def test_without_a_place_the_layout_says_where_a_key_is() -> None:
    assert kitty_decoder("de").take(b"\x1b[122u", 0) == [Key(21, "z")]
    assert kitty_decoder("us").take(b"\x1b[122u", 0) == [Key(44, "z")]
    assert kitty_decoder("de").take(b"\x1b[223;;223u", 0) == [Key(12, "ß")]
    assert kitty_decoder("us").take(b"\x1b[223;;223u", 0) == [Key(0, "ß")]


@pytest.mark.parametrize(
    "data",
    [b"\x1b[57454u", b"\x1b[57376u", b"\x1b[97;1:9u", b"\x1b[0u", b"\x1b[99999999999u",
     b"\x1b[?31u", b"\x1b[?62;4c", b"\x1b[I", b"\x1b[O", b"\x1b[57344;1:3u"],
)  # fmt: skip
def test_what_is_no_key_has_no_code(data: bytes) -> None:
    assert [key for key in kitty_decoder().take(data, 0) if key.code] == []
    assert kitty_decoder().take(data + b"\x1b[27u", 0)[-1] == Key(1, "\x1b")


def test_a_terminal_that_fell_out_of_the_protocol_still_brakes() -> None:
    decoder = kitty_decoder()
    assert decoder.strokes(b"\x1b", 0) == []
    assert decoder.strokes(b"", 25 * MS) == [Stroke(Key(1, "\x1b"), "typed")]


# --- what is down ---------------------------------------------------------------------------------


def stroke(code: int, phase: str) -> Stroke:
    return Stroke(Key(code, "x"), phase)  # type: ignore[arg-type]


def test_keys_whose_release_is_told_are_not_guessed() -> None:
    held = Held()
    assert held.codes(stroke(13, "press"), 0) == [13]
    assert held.guess.elapsed(5000 * MS) == []
    assert held.codes(stroke(12, "press"), 5000 * MS) == [12]
    assert held.codes(stroke(13, "release"), 5001 * MS) == [141]
    assert held.codes(stroke(12, "release"), 5002 * MS) == [140]


def test_a_key_that_getch_gave_out_is_guessed_until_something_is_told_of_it() -> None:
    held = Held()
    held.guess.press(13, 0)
    assert held.guess.elapsed(700 * MS) == [141]
    held.guess.press(13, 1000 * MS)
    assert held.codes(stroke(13, "repeat"), 1500 * MS) == [13]
    assert held.guess.elapsed(9000 * MS) == []
    assert held.codes(stroke(13, "release"), 9000 * MS) == [141]


def test_without_the_focus_all_keys_are_up() -> None:
    held = Held()
    held.codes(stroke(77, "press"), 0)
    held.codes(stroke(13, "press"), 0)
    held.guess.press(30, 0)
    assert held.all_up() == [141, 205, 158]
    assert held.all_up() == []


# --- asking ---------------------------------------------------------------------------------------


@dataclass
class Wire:
    """A terminal, its answers when they are fetched, and the time."""

    terminal: KittyTerminal | None
    written: list[bytes] = field(default_factory=list)
    now_ns: int = 0

    def protocol(self, wanted: str = "auto") -> Kitty:
        return Kitty(self.written.append, wanted, lambda: self.now_ns)  # type: ignore[arg-type]

    def deliver(self, kitty: Kitty) -> None:
        """All answers arrive."""
        decoder, done = Decoder("us"), 0
        while self.terminal and done < len(self.written):
            decoder.take(self.terminal.answer(self.written[done]), 0)
            done += 1
        self.written.clear()
        for report in decoder.reports:
            kitty.heard(report)


def test_a_terminal_that_knows_it_is_told_to_speak_it_and_back() -> None:
    wire = Wire(KittyTerminal())
    kitty = wire.protocol()
    kitty.begin()
    assert wire.written == [ASK_FLAGS + ASK_DEVICE]
    wire.deliver(kitty)
    assert (kitty.is_on, kitty.is_known, wire.written) == (True, True, [PUSH])
    wire.deliver(kitty)
    assert wire.terminal
    assert (wire.terminal.flags, wire.terminal.focus) == ([31], True)
    kitty.end()
    assert wire.written == [POP + ASK_DEVICE]
    assert not kitty.settled()
    wire.deliver(kitty)
    assert kitty.settled()
    assert (wire.terminal.flags, wire.terminal.focus) == ([], False)
    kitty.begin()
    assert wire.written == [PUSH]


def test_one_that_does_not_know_it_is_asked_once() -> None:
    wire = Wire(KittyTerminal(knows=False))
    kitty = wire.protocol()
    kitty.begin()
    wire.deliver(kitty)
    assert (kitty.is_on, kitty.is_known) == (False, False)
    kitty.end()
    assert kitty.settled()
    kitty.begin()
    assert wire.written == []


def test_one_that_answers_nothing_is_waited_for_once() -> None:
    wire = Wire(None)
    kitty = wire.protocol()
    kitty.begin()
    kitty.end()
    wire.now_ns = 249 * MS
    assert not kitty.settled()
    wire.now_ns = 250 * MS
    assert kitty.settled()
    wire.written.clear()
    kitty.begin()
    assert (wire.written, kitty.is_known) == ([], False)


def test_an_answer_that_comes_after_the_end_changes_nothing_on_the_screen() -> None:
    wire = Wire(KittyTerminal())
    kitty = wire.protocol()
    kitty.begin()
    kitty.end()
    wire.deliver(kitty)
    assert (kitty.is_on, kitty.is_known, wire.written) == (False, True, [])


def test_what_is_wanted_is_not_asked() -> None:
    wire = Wire(KittyTerminal())
    plain = wire.protocol("plain")
    plain.begin()
    assert wire.written == []
    wire.protocol("kitty").begin()
    assert wire.written == [PUSH]


# --- a program in such a terminal -----------------------------------------------------------------


MOVING = """
    from fraese.x4step import *
    X4Init(2)
    X4BrakeCodes([CODE, 0])
    X4MovePos(1, 1000, 50)
    print("moving", flush=True)
    while X4GetState():
        pass
    print("code", X4LastBrakeCode(), flush=True)
    print("then:", input())
    X4ReInit()
"""


@pytest.mark.alone
def test_a_release_brakes_and_nothing_reaches_the_program() -> None:
    screen = Screen()
    screen.start(MOVING.replace("CODE", "27 + 128"))
    screen.until("moving")
    screen.until_flags([31])
    screen.type(encoded("x", text="x") + encoded("x", RELEASE))
    screen.type(encoded("+", place="]", text="+"))
    time.sleep(1.0)  # Held for longer than a guess would last, without repeats.
    screen.type(encoded("+", RELEASE, place="]"))
    screen.until("code 155")
    assert screen.terminal.flags == []
    assert not screen.terminal.focus
    screen.type(b"two\n")
    assert screen.end() == 0
    assert "then: two" in screen.seen


@pytest.mark.alone
def test_losing_the_focus_is_letting_go() -> None:
    screen = Screen()
    screen.start(MOVING.replace("CODE", "205"))
    screen.until("moving")
    screen.until_flags([31])
    screen.type(encoded("RIGHT"))
    screen.type(b"\x1b[O")
    screen.until("code 205")
    screen.type(b"\n")
    assert screen.end() == 0


@pytest.mark.alone
def test_escape_is_known_at_once_and_an_arrow_is_none() -> None:
    screen = Screen()
    screen.start(MOVING.replace("CODE", "0"))
    screen.until("moving")
    screen.until_flags([31])
    for part in (b"\x1b", b"[1;1:", b"3D", b"\x1b[27;1:3u"):
        screen.type(part)
        time.sleep(0.01)
    screen.type(encoded("ESC"))
    screen.until("code 1\r\n")
    screen.type(b"\n")
    assert screen.end() == 0


@pytest.mark.alone
@pytest.mark.parametrize(
    ("number", "status"),
    [(signal.SIGTERM, 143), (signal.SIGHUP, 129), (signal.SIGINT, -signal.SIGINT)],
)
def test_the_terminal_is_as_before_after_a_signal(number: signal.Signals, status: int) -> None:
    screen = Screen()
    screen.start(MOVING.replace("CODE", "0"))
    screen.until("moving")
    screen.until_flags([31])
    os.kill(screen.child, number)
    assert screen.end() == status
    assert (screen.terminal.flags, screen.terminal.focus) == ([], False)


@pytest.mark.alone
def test_ctrl_c_stays_what_it_is_and_an_exception_gives_the_terminal_back() -> None:
    screen = Screen()
    screen.start(MOVING.replace("CODE", "0"))
    screen.until("moving")
    screen.until_flags([31])
    screen.type(encoded("c", modifiers=4))
    assert screen.end() == -signal.SIGINT
    assert "KeyboardInterrupt" in screen.seen
    assert (screen.terminal.flags, screen.terminal.focus) == ([], False)


@pytest.mark.alone
def test_ctrl_z_gives_the_terminal_back_and_takes_it_again() -> None:
    """Nobody is there to stop it for: it goes on at once."""
    screen = Screen()
    screen.start(MOVING.replace("CODE", "0"))
    screen.until("moving")
    screen.until_flags([31])
    screen.type(encoded("z", modifiers=4))
    screen.until(POP.decode())
    screen.until(PUSH.decode())
    screen.type(encoded("ESC"))
    screen.until("code 1\r\n")
    assert screen.terminal.flags == []
    screen.type(b"\n")
    assert screen.end() == 0


@pytest.mark.alone
def test_keys_of_the_terminal_brake_also_where_the_input_is_a_file(tmp_path: Path) -> None:
    """``getch`` is of the file."""
    (tmp_path / "input").write_text("ab", encoding="ascii")
    program = textwrap.dedent(MOVING.replace("CODE", "205").replace("input()", "getch()"))
    (tmp_path / "program.py").write_text(program, encoding="ascii")
    command = f"{sys.executable} {tmp_path}/program.py < {tmp_path}/input"
    screen = Screen()
    screen.start_program(
        ["/bin/sh", "-c", command],
        {**os.environ, "PYTHONPATH": str(ROOT), "XDG_CONFIG_HOME": "/no"},
    )
    screen.until("moving")
    screen.until_flags([31])
    screen.type(encoded("RIGHT") + encoded("RIGHT", RELEASE))
    screen.until("code 205")
    screen.until("then: a")
    assert screen.end() == 0
    assert screen.terminal.flags == []


GOES_ON = """
    import signal, sys, time
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    from fraese.x4step import *
    X4Init(2)
    X4MovePos(1, 1000, 50)
    print("moving", flush=True)
    while X4GetTimer() < 1500: pass
    began = time.monotonic()
    X4Brake()
    while X4GetState(): pass
    X4Load(100, 0, 0, 0, 1000, 0); X4Start()
    while X4GetState(): pass
    with open(sys.argv[1], "w") as file:
        print(X4GetSteps(1), time.monotonic() - began < 5, X4ReInit(), file=file)
"""


@pytest.mark.alone
def test_a_terminal_that_is_gone_stops_nobody(tmp_path: Path) -> None:
    screen = Screen()
    screen.start(GOES_ON, str(tmp_path / "said"))
    screen.until("moving")
    screen.until_flags([31])
    time.sleep(0.3)  # Its line is written to the end.
    os.close(screen.master)
    assert os.waitpid(screen.child, 0)[1] == 0
    assert (tmp_path / "said").read_text() == "100 True 0\n"


HELD = """
    import signal, sys
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    from fraese.x4step import *
    X4Init(2)
    X4BrakeCodes([205, 0])
    X4MovePos(1, 1000, 50)
    print("moving", flush=True)
    while X4GetState(): pass
    with open(sys.argv[1], "w") as file:
        print(X4LastBrakeCode(), X4ReInit(), file=file)
"""


@pytest.mark.alone
def test_a_key_that_is_held_when_the_terminal_goes_is_up(tmp_path: Path) -> None:
    screen = Screen()
    screen.start(HELD, str(tmp_path / "said"))
    screen.until("moving")
    screen.until_flags([31])
    screen.type(encoded("RIGHT"))
    time.sleep(0.3)
    os.close(screen.master)
    assert os.waitpid(screen.child, 0)[1] == 0
    assert (tmp_path / "said").read_text() == "205 0\n"


@pytest.mark.alone
def test_getch_gives_characters_and_places() -> None:
    screen = Screen()
    screen.start("""
        from fraese.x4step import *
        print("go", flush=True)
        for _ in range(3):
            print(repr(getch()), last_scan_code(), flush=True)
        print("then:", input())
    """)
    screen.until("go")
    screen.until_flags([31])
    screen.type(encoded("SHIFT", modifiers=1) + encoded("z", modifiers=1, place="y", text="Z"))
    screen.until("'Z' 21")
    screen.until_flags([31])
    screen.type(encoded("LEFT"))
    screen.until(r"'\x00' 75")
    screen.until("'K' 75")
    screen.until_flags([])
    screen.type(b"done\n")
    assert screen.end() == 0
    assert "then: done" in screen.seen


@pytest.mark.alone
def test_scancodes_with_releases() -> None:
    screen = Screen()
    screen.start("", "scancodes")
    screen.until("Keys come from the terminal, which tells releases (kitty keyboard protocol).")
    screen.type(encoded("LEFT") + encoded("LEFT", REPEAT) + encoded("LEFT", RELEASE))
    screen.until("LEFT       make  75  break 203  down")
    screen.until("LEFT       make  75  break 203  repeats")
    screen.until("LEFT       make  75  break 203  up")
    screen.type(2 * (encoded("ESC") + encoded("ESC", RELEASE)))
    assert screen.end() == 0
    assert (screen.terminal.flags, screen.terminal.focus) == ([], False)


@pytest.mark.alone
def test_scancodes_in_a_terminal_that_does_not_know_it() -> None:
    screen = Screen(KittyTerminal(knows=False))
    screen.start("", "scancodes")
    screen.until("Keys come from the terminal, which does not tell releases.")
    screen.type(b"\x1b[D")
    screen.until("LEFT       make  75  break 203\r\n")
    screen.type(b"\x1b")
    screen.until("ESC        make   1  break 129\r\n")
    screen.type(b"\x1b")
    assert screen.end() == 0
    assert PUSH.decode() not in screen.seen


@pytest.mark.alone
def test_hold_to_move_in_the_test_program() -> None:
    """Held for a second without repeats, then let go; then ESC."""
    screen = Screen()
    screen.start("", "bench")
    for word, line in (("1->", b"f1000\n"), ("1->", b"r10\n"), ("1->", b"c\n")):
        screen.until(word)
        screen.type(line)
    screen.until("ESC ends it.")
    screen.type(b"\x1b[C")
    screen.until_flags([31])
    for _ in range(20):
        screen.type(encoded("RIGHT", REPEAT))
        time.sleep(0.05)
    screen.type(encoded("RIGHT", RELEASE))
    screen.until("Steps of axes 1 to 4: ")
    screen.until("\n")
    steps = int(screen.seen[: screen.mark].rsplit("4: ", 1)[1].split(",")[0])
    assert 900 < steps < 1600
    screen.type(b"\x1b")
    screen.until("1->")
    screen.type(b"q\n")
    assert screen.end() == 0
