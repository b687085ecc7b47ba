"""Keyboards of Linux, as pipes and files with events."""

import os
import struct
import subprocess
import sys
import time
from collections import deque
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.config.x4step import X4StepConfig
from fraese.errors import ConfigError
from fraese.x4step import evdev
from fraese.x4step.decoder import Held, Key, Stroke
from fraese.x4step.evdev import NATIVE, EvdevKeys, EventDevice, keyboards
from fraese.x4step.keyboard import EVDEV_CODES, MAKE_CODES
from fraese.x4step.keys import HandKeys, NoKeys
from fraese.x4step.surroundings import WantedKeys, program_keys, wanted_keys
from fraese.x4step.terminal import TerminalKeys

ROOT = Path(__file__).parents[2]
#: struct input_event on machines of 64 and of 32 bits.
LAYOUTS: Final = {"64": struct.Struct("<qqHHi"), "32": struct.Struct("<iiHHi")}
UP, DOWN, REPEAT = 0, 1, 2
SYN: Final = (0, 0, 0)
DROPPED: Final = (0, 3, 0)
MISC: Final = (4, 4, 458792)  # the scan code of a USB keyboard, sent before every key


class Pipe:
    """A keyboard that a test types on."""

    def __init__(self, layout: struct.Struct = NATIVE) -> None:
        self.layout = layout
        reader, self.writer = os.pipe2(os.O_NONBLOCK)
        self.device = EventDevice(reader, layout)

    def send(self, *events: tuple[int, int, int]) -> None:
        for event in events:
            os.write(self.writer, self.layout.pack(1700000000, 500000, *event))

    def key(self, number: int, value: int) -> None:
        self.send(MISC, (1, number, value), SYN)

    def unplug(self) -> None:
        writer, self.writer = self.writer, -1
        if writer >= 0:
            os.close(writer)


@pytest.fixture
def pipe() -> Iterator[Pipe]:
    pipe = Pipe()
    yield pipe
    pipe.unplug()
    pipe.device.close()


def test_the_struct_is_that_of_this_machine() -> None:
    assert NATIVE.size == 2 * struct.calcsize("l") + 8
    assert (LAYOUTS["64"].size, LAYOUTS["32"].size) == (24, 16)


@pytest.mark.parametrize(
    ("number", "name"),
    [(1, "ESC"), (2, "1"), (28, "ENTER"), (44, "Z"), (58, "CAPSLOCK"), (59, "F1"), (83, "DELETE"),
     (86, "102ND"), (87, "F11"), (88, "F12"), (96, "ENTER"), (97, "CTRL"), (98, "/"), (99, "KP*"),
     (100, "ALT"), (102, "HOME"), (103, "UP"), (104, "PAGEUP"), (105, "LEFT"), (106, "RIGHT"),
     (107, "END"), (108, "DOWN"), (109, "PAGEDOWN"), (110, "INSERT"), (111, "DELETE")],
)  # fmt: skip
def test_keys_of_linux(number: int, name: str) -> None:
    assert EVDEV_CODES[number] == MAKE_CODES[name]


@pytest.mark.parametrize("number", [0, 84, 85, 101, 113, 125, 272, 330])
def test_what_x4step_does_not_know_has_no_code(number: int, pipe: Pipe) -> None:
    assert number not in EVDEV_CODES
    pipe.key(number, DOWN)
    assert pipe.device.codes() == []


events = st.lists(
    st.tuples(st.sampled_from(sorted(EVDEV_CODES)), st.sampled_from([UP, DOWN, REPEAT])), max_size=8
)


@given(typed=events, bits=st.sampled_from(list(LAYOUTS)), data=st.data())
def test_what_is_sent_is_heard_in_pieces_of_any_size(
    typed: list[tuple[int, int]], bits: str, data: st.DataObject
) -> None:
    layout = LAYOUTS[bits]
    sent = b"".join(layout.pack(17, 5, *event) for key in typed for event in (MISC, (1, *key), SYN))
    cuts = sorted(data.draw(st.sets(st.integers(1, max(1, len(sent) - 1)), max_size=5)))
    pipe, codes = Pipe(layout), []
    for first, last in zip([0, *cuts], [*cuts, len(sent)], strict=True):
        os.write(pipe.writer, sent[first:last])
        codes += pipe.device.codes()
    assert codes == [EVDEV_CODES[key] | (0 if value else 128) for key, value in typed]
    pipe.unplug()
    pipe.device.close()


@pytest.mark.parametrize("bits", list(LAYOUTS))
def test_a_recorded_file(tmp_path: Path, bits: str) -> None:
    layout = LAYOUTS[bits]
    record = [(MISC), (1, 78, DOWN), SYN, (1, 78, REPEAT), SYN, (1, 78, UP), SYN, (1, 1, DOWN), SYN]
    path = tmp_path / "event0"
    path.write_bytes(b"".join(layout.pack(17, 5, *event) for event in record))
    device = EventDevice(os.open(path, os.O_RDONLY), layout)
    # At its end it is unplugged: ESC is up.
    assert device.codes() == [78, 78, 206, 1, 129]
    assert device.codes() == []


def test_a_keyboard_that_is_unplugged_has_its_keys_up(pipe: Pipe) -> None:
    pipe.key(105, DOWN)
    pipe.key(13, DOWN)
    assert pipe.device.codes() == [75, 13]
    pipe.unplug()
    assert pipe.device.codes() == [141, 203]
    assert pipe.device.codes() == []


def test_lost_events_are_releases(pipe: Pipe) -> None:
    pipe.key(106, DOWN)
    pipe.send(DROPPED, SYN)
    pipe.key(1, DOWN)
    assert pipe.device.codes() == [77, 205, 1]


# --- beside a terminal ----------------------------------------------------------------------------


def test_keys_of_the_terminal_count_too_but_not_twice(pipe: Pipe) -> None:
    hand = HandKeys()
    keys = EvdevKeys([pipe.device], hand, "a keyboard")
    pipe.key(30, DOWN)  # in another window, long ago
    keys.begin()
    hand.press(28)  # at another keyboard
    hand.press(156)
    assert keys.codes() == [28, 156]
    pipe.key(13, DOWN)
    hand.press(13)
    assert keys.codes() == [13]
    hand.press(13)
    hand.press(141)  # a guess of the terminal: the keyboard knows better
    assert keys.codes() == []
    pipe.key(13, UP)
    assert keys.codes() == [141]
    # ESC is never held back.
    pipe.key(1, DOWN)
    pipe.key(1, UP)
    assert keys.codes() == [1, 129]
    hand.press(1)
    assert keys.codes() == [1]
    keys.end()


def test_what_was_typed_before_brakes_nothing(pipe: Pipe) -> None:
    keys = EvdevKeys([pipe.device], HandKeys(), "a keyboard")
    pipe.key(1, DOWN)
    pipe.key(1, UP)
    pipe.key(28, DOWN)
    keys.begin()
    assert keys.codes() == []
    pipe.key(28, UP)
    assert keys.codes() == [156]


class Given(TerminalKeys):
    """A terminal that has handed out a key."""

    def __init__(self, code: int) -> None:
        self.held = Held()
        self.held.guess.press(code, 0)
        self.sent: deque[list[int]] = deque()

    def begin(self) -> None:
        pass

    def codes(self) -> list[int]:
        return self.sent.popleft() if self.sent else []

    def end(self) -> None:
        pass


@pytest.mark.parametrize(
    ("tapped", "first", "left"),
    [([DOWN, UP], [205], 0), ([DOWN], [], 0), ([DOWN, UP, DOWN], [], 0), ([], [], 77)],
    ids=["let go already", "still down", "down again", "at another keyboard"],
)
def test_a_key_that_was_handed_out_and_let_go_before_the_start_brakes_at_once(
    pipe: Pipe, tapped: list[int], first: list[int], left: int
) -> None:
    terminal = Given(77)
    keys = EvdevKeys([pipe.device], terminal, "a keyboard")
    for value in tapped:
        pipe.key(106, value)
    keys.begin()
    assert keys.codes() == first
    assert terminal.held.guess.down == left
    assert keys.codes() == []


def test_strokes_for_scancodes(pipe: Pipe) -> None:
    keys = EvdevKeys([pipe.device], NoKeys(None), "a keyboard")
    keys.begin()
    pipe.key(105, DOWN)
    pipe.key(105, UP)
    assert keys.strokes() == [Stroke(Key(75, ""), "press"), Stroke(Key(75, ""), "release")]


# --- which ----------------------------------------------------------------------------------------


def test_named_devices_are_opened_and_others_only_if_they_are_keyboards(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "event7").write_bytes(b"")
    monkeypatch.setattr(evdev, "FOLDER", tmp_path)
    assert keyboards(()) == []
    assert [path.name for path, _ in keyboards([tmp_path / "event7", tmp_path / "event8"])] == [
        "event7"
    ]


@pytest.mark.parametrize(
    ("named", "variable", "expected"),
    [(None, None, WantedKeys("de", "kitty")), (None, "plain", WantedKeys("de", "plain")),
     ("auto", "plain", WantedKeys("de", "auto")),
     (None, "evdev:/dev/input/event3", WantedKeys("de", "evdev", ("/dev/input/event3",))),
     ("evdev:/a,/b", None, WantedKeys("de", "evdev", ("/a", "/b"))),
     ("evdev", None, WantedKeys("de", "evdev"))],
)  # fmt: skip
def test_a_flag_comes_before_the_environment_and_that_before_the_configuration(
    named: str | None, variable: str | None, expected: WantedKeys
) -> None:
    config = X4StepConfig(keyboard="de", keys="kitty")
    environment = {"FRAESE_X4STEP_KEYS": variable} if variable else {}
    assert wanted_keys(config, named, environment) == expected


def test_a_dumb_terminal_is_not_asked() -> None:
    assert wanted_keys(X4StepConfig(), None, {"TERM": "dumb"}).source == "plain"
    assert wanted_keys(X4StepConfig(), None, {"TERM": "linux"}).source == "auto"


@pytest.mark.parametrize("said", ["mouse", "kitty:/dev/input/event3", ""])
def test_no_source_of_keys(said: str) -> None:
    with pytest.raises(ConfigError, match=r"--keys: .* is no source of keys"):
        wanted_keys(X4StepConfig(), said or "x", {})


def test_without_a_readable_keyboard_the_terminal_is_left(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    source = program_keys(WantedKeys("us", "evdev", (str(tmp_path / "event9"),)))
    assert isinstance(source, NoKeys)
    assert "event9 can be read, so keys come from the terminal alone" in capsys.readouterr().err


@pytest.mark.alone
def test_a_program_is_braked_by_a_keyboard_of_linux(tmp_path: Path) -> None:
    path = tmp_path / "event0"
    os.mkfifo(path)
    writer = os.open(path, os.O_RDWR)
    program = """if True:
        from fraese.x4step import *
        X4Init(2); X4BrakeCodes([205]); X4MovePos(1, 1000, 50)
        print("moving", flush=True)
        while X4GetState(): pass
        print(X4LastBrakeCode(), X4GetSteps(1) > 0, flush=True)
        X4ReInit()
    """
    child = subprocess.Popen(
        [sys.executable, "-c", program],
        cwd=ROOT,
        env={**os.environ, "FRAESE_X4STEP_KEYS": f"evdev:{path}", "XDG_CONFIG_HOME": "/no"},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        text=True,
    )
    with child:
        assert child.stdout
        assert child.stdout.readline() == "moving\n"
        for value in (DOWN, REPEAT, UP):
            time.sleep(0.05)
            os.write(writer, NATIVE.pack(1, 2, 1, 106, value) + NATIVE.pack(1, 2, *SYN))
        assert child.stdout.read() == "205 True\n"
    assert child.returncode == 0
    os.close(writer)
