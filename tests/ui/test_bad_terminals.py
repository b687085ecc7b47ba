"""The app in terminals that nobody reads, that send nonsense, that are none, and that go away."""

import asyncio
import contextlib
import gc
import itertools
import os
import random
import select
import signal
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import pytest

pytest.importorskip("pty")

from textual.drivers.linux_driver import LinuxDriver
from textual.events import Key
from textual.message import Message
from textual.widgets import Input

from fraese.config import Config
from fraese.ui.screenwriter import ScreenWriter
from fraese.ui.terminal import Terminal
from tests.fuzz.lengths import FACTOR
from tests.terminals import Pty
from tests.ui.helpers import bench, play

APP = [sys.executable, "-m", "fraese"]
RIGHT = b"\x1b[C"
QUIT = b"\x11"
#: Random sequences of keys; ``make fuzz`` makes it 10,000.
SEQUENCES = 200 * FACTOR


def environment(folder: Path, **also: str) -> dict[str, str]:
    return {
        **os.environ,
        "TERM": "xterm-256color",
        "XDG_CONFIG_HOME": str(folder / "config"),
        "XDG_STATE_HOME": str(folder / "state"),
        "PYTHONPATH": os.environ.get("PYTHONPATH") or str(Path(__file__).parents[2]),
        **also,
    }


def tracked_objects() -> int:
    """How many there are that could hold others.

    They are counted where they lie: a list of them also holds a tuple that another thread is
    just making, which Python then refuses to finish.
    """
    gc.collect()
    gc.freeze()
    try:
        return gc.get_freeze_count()
    finally:
        gc.unfreeze()


@contextmanager
def app(
    folder: Path, *, size: tuple[int, int] = (24, 80), words: tuple[str, ...] = (), **also: str
) -> Iterator[Pty]:
    pty = Pty([*APP, *words], folder, environment(folder, **also), size=size)
    try:
        yield pty
    finally:
        pty.close()


@contextmanager
def jogging(folder: Path) -> Iterator[Pty]:
    """On a way of 10 mm, slow enough that it takes many seconds."""
    (folder / "fraese.toml").write_text("[jog]\nfeed_mm_min = 30\n")
    with app(folder) as pty:
        pty.read_until(b"Hold")
        pty.type(b"5")
        pty.type(RIGHT)
        pty.read_until(b"mm/min")
        yield pty


def carriage_steps(folder: Path) -> tuple[int, ...]:
    """Where the next program finds the machine."""
    from fraese.assembly import assemble

    plant = assemble(Config(), state=folder / "state" / "fraese")
    try:
        assert not any("ended while the machine moved" in note for note in plant.notes)
        return plant.controller.position.position_steps
    finally:
        plant.controller.close()


# --- nobody reads --------------------------------------------------------------------------------


@pytest.mark.alone
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGINT])
def test_a_signal_is_heard_while_nobody_reads(tmp_path: Path, number: signal.Signals) -> None:
    with jogging(tmp_path) as pty:
        # Pictures until there is no room for another.
        for _ in range(30):
            pty.type(b"v")
            time.sleep(0.05)
        pty.process.send_signal(number)
        assert pty.end(reading=False, within_s=3) == 128 + number
    assert 0 < carriage_steps(tmp_path)[0] < 2000


@pytest.mark.alone
def test_the_quit_key_is_heard_while_nobody_reads(tmp_path: Path) -> None:
    with jogging(tmp_path) as pty:
        for _ in range(30):
            pty.type(b"v")
            time.sleep(0.05)
        pty.type(QUIT)
        assert pty.end(reading=False, within_s=3) == 0
    assert 0 < carriage_steps(tmp_path)[0] < 2000


@pytest.mark.alone
def test_a_closed_window_ends_the_app(tmp_path: Path) -> None:
    with jogging(tmp_path) as pty:
        pty.hang_up()
        assert pty.end(reading=False, within_s=3) in (128 + signal.SIGHUP, 128 + signal.SIGTERM)
    assert 0 < carriage_steps(tmp_path)[0] < 2000


def test_who_reads_again_sees_all(tmp_path: Path) -> None:
    with app(tmp_path) as pty:
        pty.read_until(b"Hold")
        until_s = time.monotonic() + 20
        # Until pictures must have been dropped.
        for _ in range(120):
            pty.type(b"v")
            time.sleep(0.02)
        assert time.monotonic() < until_s
        while pty.read(1.0):
            pass
        shown = pty.drawn[-6000:]
        for word in (b"fraese", b"Hold", b"motors off"):
            assert word in pty.drawn, shown
        pty.type(QUIT)
        assert pty.end(reading=True) == 0


# --- no terminal to speak of ---------------------------------------------------------------------


@pytest.mark.alone
@pytest.mark.parametrize("end", ["key", "signal"])
@pytest.mark.parametrize(
    ("term", "size"),
    [("dumb", (24, 80)), ("xterm", (0, 0)), ("dumb", (0, 0)), ("", (1, 1)), ("nonsense", (500, 2))],
)
def test_quit_and_signal_are_heard_in_any_terminal(
    tmp_path: Path, term: str, size: tuple[int, int], end: str
) -> None:
    with app(tmp_path, size=size, TERM=term) as pty:
        # It has taken the terminal, and hears.
        pty.read_until(b"\x1b[?1049h")
        while pty.read(1.0):
            pass
        pty.type(b"5" + RIGHT)
        if end == "key":
            pty.type(QUIT)
            assert pty.end(reading=True, within_s=5) == 0
        else:
            pty.process.send_signal(signal.SIGTERM)
            assert pty.end(reading=True, within_s=5) == 128 + signal.SIGTERM


def test_a_terminal_that_shrinks_to_nothing(tmp_path: Path) -> None:
    with app(tmp_path) as pty:
        pty.read_until(b"Hold")
        for size in ((0, 0), (1, 1), (24, 80), (0, 80), (24, 0), (300, 1), (1, 300), (24, 80)):
            pty.resize(*size)
            while pty.read(0.2):
                pass
        pty.type(QUIT)
        assert pty.end(reading=True) == 0


# --- nonsense ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "nonsense",
    [
        b"\xff",
        b"\xc3",
        b"\x80\x80\xf8\x88\x80\x80\x80",
        b"\x1b[",
        b"\x1b[<99999999999;0;0M",
        b"\x1b[<0;-1;-1M\x1b[<64;1;1M",
        b"\x1b[48;99999;99999;1;1t",
        b"\x1b[48;0;0;0;0t\x1b[<0;5;5M",
        b"\x1bP" + b"q" * 500,
        b"\x1b]52;c;" + b"A" * 5000,
        b"\x1b[200~" + b"paste " * 20_000 + b"\x1b[201~",
    ],
)
def test_nonsense_does_not_end_the_app(tmp_path: Path, nonsense: bytes) -> None:
    with app(tmp_path) as pty:
        pty.read_until(b"Hold")
        pty.type(b"g")
        typed = threading.Thread(target=pty.type, args=(nonsense,))
        typed.start()
        # A cursor that blinks, twice a second, is no news.
        while typed.is_alive() or pty.read(0.2):
            pty.read(0.05)
        assert pty.process.poll() is None
        pty.type(QUIT)
        assert pty.end(reading=True) == 0, pty.drawn[-3000:]


@pytest.mark.alone
def test_a_paste_without_an_end_swallows_no_stop_key(tmp_path: Path) -> None:
    with jogging(tmp_path) as pty:
        pty.type(b"\x1b[200~G1 X")
        time.sleep(0.2)
        pty.type(b"\x03")
        pty.read_until(b"Cancelled")
        # And a moment later keys are keys again.
        time.sleep(1.2)
        pty.type(QUIT)
        assert pty.end(reading=True) == 0


@pytest.mark.parametrize(
    "torn",
    [
        [b"\x1b[200~text", b"", b"", b"\x1b", b"", b"", b"[201~"],
        [b"\x1b[200~text\x1b[20", b"", b"", b"1~"],
        [b"\x1b[2", b"00~text"],
        [b"\x1b[200~text\x1b[D7"],
        [b"\x1b[200~" + b"x" * 400_000] * 3,
    ],
)
def test_a_torn_paste_is_given_up_and_keys_are_keys_again(torn: list[bytes]) -> None:
    from fraese.ui import terminal

    keys = terminal._Keys()
    for piece in [*torn, *[b""] * 10]:
        list(keys.heard(piece))
        if not piece:
            # The parser's patience with a lone escape is over.
            keys._parser._timeout_time = keys._parser._timeout_time and 0.0
    assert [message.key for message in keys.heard(b"a\x11") if isinstance(message, Key)] == [
        "a",
        "ctrl+q",
    ]


def test_ctrl_c_in_a_paste_is_heard_at_once() -> None:
    from fraese.ui import terminal

    keys = terminal._Keys()
    list(keys.heard(b"\x1b[200~G1 X"))
    heard = [message.key for message in keys.heard(b"1\x03") if isinstance(message, Key)]
    assert heard == ["ctrl+c"]
    assert [m.key for m in terminal._Keys().heard(b"\x03") if isinstance(m, Key)] == ["ctrl+c"]


PIECES = [
    b"\x1b[", b"\x1b", b"\x1bO", b"\x1b[<", b"\x1b[200~", b"\x1b[201~", b"\x1b]0;", b"\x1bP",
    b"\x9b", b"\x1b[M", b"\x1b[?2026;", b"\x1b[?2048;", b"\x1b[48;", b";", b"M", b"t", b"u", b"~",
    b"$y", b"R", RIGHT, b"\x1b[D", b"\x1b[A", b"\x1b[5~", b"\r", b"\t", b"\x7f", b"\x00", b"\xff",
    b"\xe6\xbc", b"\xed\xa0\x80", b"1", b"5", b"g", b"o", b"h", b"s", b"z", b"?", b"x", b"0", b"v",
]  # fmt: skip


def sequences(seed: int) -> Iterator[bytes]:
    """Bytes as a broken line, a cat on the keyboard and a paste would send them; no way to quit."""
    chance = random.Random(seed)
    while True:
        kind = chance.random()
        if kind < 0.6:
            made = b"".join(chance.choices(PIECES, k=chance.randrange(1, 12)))
        elif kind < 0.95:
            made = chance.randbytes(chance.randrange(1, 40))
        else:
            made = b"\x1b[200~" + chance.randbytes(chance.randrange(20_000)) + b"\x1b[201~"
        # Ctrl+Q and Ctrl+P leave, or lead there; q leaves; Ctrl+Z stops the process.
        yield made.translate(None, b"\x11\x10\x1aqQ")


def has_left(pty: Pty, told: object) -> bool:
    """It was made to leave (a click on Quit, a report of its key), and has left in order."""
    if pty.process.poll() is None:
        return False
    pty.end(reading=True)
    assert b"Traceback" not in pty.drawn, (told, pty.drawn[-3000:])
    # What is typed while it gives the terminal back is the terminal's, Ctrl+C and Ctrl+\\ too.
    assert b"\x1b[?1049l" in pty.drawn, (told, pty.drawn[-3000:])
    assert pty.process.returncode in (0, 128 + signal.SIGINT, -signal.SIGINT, -signal.SIGQUIT), told
    return True


def type_at(folder: Path, typed: Iterator[tuple[int, bytes]], told: object) -> None:
    """Into one app, until there is no more, or it has left."""
    with app(folder) as pty:
        pty.read_until(b"Hold")
        for number, made in typed:
            writer = threading.Thread(target=pty.type, args=(made,))
            writer.start()
            while writer.is_alive():
                pty.read(0.01)
            pty.read(0)
            pty.drawn = pty.drawn[-20_000:]
            if has_left(pty, (told, number)):
                return
        # Out of whatever was open, and out.
        time.sleep(1.5)
        while pty.read(0.2):
            pass
        if not has_left(pty, told):
            pty.type(QUIT)
            with contextlib.suppress(AssertionError):
                pty.end(reading=True)
            assert pty.process.poll() == 0, (told, pty.drawn[-3000:])


@pytest.mark.alone
def test_the_app_lives_whatever_is_typed(tmp_path: Path) -> None:
    seed = random.randrange(1 << 32) if FACTOR > 1 else 20
    typed = iter(list(enumerate(itertools.islice(sequences(seed), SEQUENCES))))
    left = True
    while left:
        type_at(tmp_path, typed, seed)
        following = next(typed, None)
        left = following is not None


# --- a crash, and foreign text -------------------------------------------------------------------

CRASH = """
import sys
from fraese.ui.views.machine import MachineView
def broken(self, *args):
    raise RuntimeError("broken on purpose")
setattr(MachineView, {where!r}, broken)
from fraese.cli import main
main()
"""


@pytest.mark.alone
@pytest.mark.parametrize("reading", [True, False])
def test_a_crash_is_never_0(tmp_path: Path, reading: bool) -> None:
    (tmp_path / "fraese.toml").write_text("[jog]\nfeed_mm_min = 30\n")
    (tmp_path / "crash.py").write_text(CRASH.format(where="action_go_to"))
    pty = Pty([sys.executable, "crash.py"], tmp_path, environment(tmp_path))
    try:
        pty.read_until(b"Hold")
        pty.type(b"5" + RIGHT)
        pty.read_until(b"mm/min")
        pty.type(b"g")
        assert pty.end(reading=reading, within_s=5) == 1
    finally:
        pty.close()
    assert 0 < carriage_steps(tmp_path)[0] < 2000


HOSTILE = "\x1b]0;owned\x07\x1b]52;c;aGk=\x1b\\\x9b2J\u202egnp"
COMMANDS = (b"\x1b]0;", b"owned\x07", b"\x1b]52", b"\xc2\x9b", "\u202e".encode())


def test_nothing_foreign_reaches_the_terminal(tmp_path: Path) -> None:
    name = f"{HOSTILE.replace('/', '')}.ngc"
    (tmp_path / name).write_text(f"({HOSTILE})\n(MSG,{HOSTILE})\nG0 X1\n(PRINT,{HOSTILE})\nM2\n")
    with app(tmp_path, words=("--open", name), size=(45, 140)) as pty:
        pty.read_until(b"Start it")
        pty.type(b"s")
        pty.read_until(b"from line")
        pty.type(b"\r")
        seen = b""
        for keys in (b"vo", b"\x1b", b"v", b"v"):
            until_s = time.monotonic() + 1.5
            while time.monotonic() < until_s:
                pty.read(0.1)
            pty.type(keys)
        while pty.read(0.2):
            pass
        seen += pty.drawn
        pty.type(QUIT)
        pty.end(reading=True)
        seen += pty.drawn
    assert b"\\u202e" in seen
    for raw in COMMANDS:
        assert raw not in seen


# --- what writes ---------------------------------------------------------------------------------


def test_a_reader_that_stops_delays_no_writer() -> None:
    read, write = os.pipe()
    caught_up = threading.Event()
    writer = ScreenWriter(write, caught_up.set, lambda: None)
    begun_s = time.monotonic()
    for number in range(2000):
        writer.write(f"{number:04} " + "x" * 1000)
    assert time.monotonic() - begun_s < 5
    seen = b""
    while not caught_up.is_set() or select.select([read], [], [], 0)[0]:
        seen += os.read(read, 65536)
    # In order, whole, and not all of it.
    numbers = [int(piece[:4]) for piece in seen.replace(b"x" * 1000, b"\n").split(b"\n") if piece]
    assert numbers[: len(numbers)] == list(range(len(numbers)))
    assert len(numbers) < 2000
    writer.begin_last_words()
    writer.write("the end")
    writer.close()
    assert os.read(read, 100) == b"the end"
    for fd in (read, write):
        os.close(fd)


def test_last_words_are_all_that_a_stalled_terminal_gets() -> None:
    read, write = os.pipe()
    thrown_away = []

    def throw_away() -> None:
        thrown_away.append(os.read(read, 1 << 20))

    writer = ScreenWriter(write, lambda: None, throw_away)
    for _ in range(200):
        writer.write("x" * 1000)
    writer.begin_last_words()
    writer.write("\x1b[?1049l")
    writer.close()
    assert thrown_away
    assert os.read(read, 1 << 20).endswith(b"\x18\x1b\\\x1b[?1049l")
    for fd in (read, write):
        os.close(fd)


def test_a_terminal_that_is_gone_is_no_error() -> None:
    read, write = os.pipe()
    os.close(read)
    writer = ScreenWriter(write, lambda: None, lambda: None)
    writer.write("x")
    writer.close()
    writer.write("x")
    os.close(write)


def test_what_waits_to_be_done_is_bounded() -> None:
    async def scene() -> None:
        async with bench() as b:
            assert b.app.backlog() == 0
            b.app._in_app = lambda action: None
            for _ in range(300):
                b.app.hears()
            assert b.app.backlog() == 300

    play(scene)


@pytest.mark.parametrize(("key", "is_heard"), [("x", False), ("ctrl+q", True), ("escape", True)])
def test_where_too_much_waits_the_stop_and_quit_keys_are_heard(
    monkeypatch: pytest.MonkeyPatch, key: str, is_heard: bool
) -> None:
    passed: list[Message] = []
    monkeypatch.setattr(LinuxDriver, "process_message", lambda _, message: passed.append(message))
    terminal = Terminal.__new__(Terminal)
    terminal._app = SimpleNamespace(backlog=lambda: 201, hears=lambda: None)  # type: ignore[assignment]
    terminal.process_message(Key(key, None))
    assert bool(passed) == is_heard


def test_a_refused_key_that_is_held_fills_neither_screen_nor_memory() -> None:
    async def scene() -> None:
        async with bench(clock="paced") as b:
            await b.long_move()
            await b.press(*["right"] * 12)
            assert len(b.app._notifications) <= 2
            await b.press("ctrl+c")
            await b.settled()
            for number in range(20):
                b.app.notify(f"notice {number}", timeout=60)
                await b.pilot.pause()
            shown = [notice.message for notice in b.app._notifications]
            assert 1 <= len(shown) <= 5
            assert "notice 19" in shown

    play(scene)


def test_a_key_that_is_held_and_refused_leaves_nothing_behind() -> None:
    """As many objects after 1,500 presses as before; twenty minutes are 36,000."""

    async def scene() -> None:
        async with bench() as b:
            b.mill.mill.place(0, 300 * 200 - 100)
            await b.jog("right")

            async def hold(presses: int) -> int:
                begun_s = time.monotonic()
                for number in range(presses):
                    key = Key("left", None)
                    key.time = begun_s + number / 30
                    b.app.post_message(key)
                    if number % 20 == 0:
                        await asyncio.sleep(0)
                await b.settled()
                assert "Acknowledge" in b.text("#message")
                return tracked_objects()

            before = await hold(200)
            assert await hold(1500) < before + 700

    play(scene)


@pytest.mark.parametrize("key", ["g", "o"])
def test_a_text_that_is_typed_has_an_end(key: str) -> None:
    """Each key in a long text takes longer than the one before: the quit key would wait."""

    async def scene() -> None:
        async with bench() as b:
            await b.press(key)
            field = b.app.screen.query_one(Input)
            field.insert_text_at_cursor("1" * 400)
            for _ in range(100):
                field.insert_text_at_cursor("1" * 100)
            assert 400 <= len(field.value) <= 2000
            await b.press("escape")

    play(scene)
