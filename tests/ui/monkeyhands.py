"""The hands of the monkey: everything that can be done at a terminal, at random."""

import random
import string
from collections.abc import Callable
from typing import Final

from textual import events
from textual.geometry import Size
from textual.message import Message

from fraese.ui import FraeseApp
from fraese.ui.keyrows import KeyTable
from fraese.ui.messages import KeyUp
from fraese.ui.shape import shape_of
from fraese.ui.widgets.jogpad import JogButton

_WORDS: Final = (
    "5", "-3", "12.5", "x10 y2", "G0 X5", "G1 Y9 F300", "G91 G1 X-3 F200", "G10 L20 P1 X0", "M3",
    "G38.2 Z-5 F50", "1e9", "nan", "ä€漢", "/etc/passwd", "piece.nc", "9" * 400,
)  # fmt: skip
_MORE_KEYS: Final = (
    "tab", "shift+tab", "enter", "backspace", "delete", "home", "end", "insert", "ctrl+a", "ctrl+z",
    "ctrl+k", "ctrl+v", "ctrl+x", "ctrl+u", "f3", "f9", "f12", "shift+up", "ctrl+left",
)  # fmt: skip
#: They end a life; the monkey has them seldom.
_WAYS_OUT: Final = frozenset({"q", "ctrl+q"})


class Hands:
    """Everything that a monkey does at a terminal, at random.

    Args:
        app: what it has before it.
        chance: what it does.
    """

    def __init__(self, app: FraeseApp, chance: random.Random) -> None:
        self._app = app
        self._chance = chance
        table = KeyTable(shape_of(app.link._controller))
        named = {key for row in table.rows for key in row.each} | {"escape", "ctrl+c", "ctrl+p"}
        self._keys = sorted((named | set(_MORE_KEYS)) - _WAYS_OUT)
        self._jogs = sorted(
            {key for row in table.rows if row.action.startswith("jog(") for key in row.each}
        )
        self._is_down = False
        self._doings: tuple[tuple[Callable[[random.Random], str | None], float], ...] = (
            (self._key, 40), (self._printable, 20), (self._repeat, 6), (self._word, 5),
            (self._move, 8), (self._down, 6), (self._up, 6), (self._click, 8), (self._scroll, 3),
            (self._resize, 2), (self._paste, 2), (self._focus, 1), (self._release, 1),
            (self._out, 0.1), (self._pad, 2), (self._leave_window, 1),
        )  # fmt: skip

    def do(self) -> tuple[str, float]:
        """One thing; what it was, and how long nothing comes then, s."""
        chance = random.Random(self._chance.randrange(1 << 62))
        doings, weights = zip(*self._doings, strict=True)
        done = chance.choices(doings, weights)[0](chance)
        pause_s = chance.choices((0.0, 0.002, chance.random() * 0.6), (80, 19, 1))[0]
        return f"{done} +{pause_s:.3f} s", pause_s

    def _tell(self, message: Message) -> None:
        driver = self._app._driver
        assert driver is not None
        driver.process_message(message)

    # --- keys ------------------------------------------------------------------------------------

    def _press(self, key: str) -> str:
        names = {" ": "space"}
        char = key if len(key) == 1 else None
        self._tell(events.Key(names.get(key, key), char))
        return f"key {key}"

    def _key(self, chance: random.Random) -> str:
        return self._press(chance.choice(self._keys))

    def _printable(self, chance: random.Random) -> str:
        return self._press(chance.choice([c for c in string.printable[:95] if c != "q"]))

    def _repeat(self, chance: random.Random) -> str:
        key, times = chance.choice(self._jogs), chance.randrange(2, 15)
        for _ in range(times):
            self._press(key)
        return f"key {key} {times} times"

    def _word(self, chance: random.Random) -> str:
        word = chance.choice(_WORDS)
        for char in word:
            self._press(char)
        self._press("enter")
        return f"typed {word!r}, enter"

    def _out(self, chance: random.Random) -> str:
        return self._press(chance.choice(sorted(_WAYS_OUT)))

    def _release(self, chance: random.Random) -> str:
        tells = chance.random() < 0.5
        self._app.tells_releases(tells)
        key = chance.choice(self._jogs)
        self._app.lets_go(key)
        self._tell(KeyUp(key))
        return f"releases told: {tells}; {key} up"

    # --- mouse -----------------------------------------------------------------------------------

    def _at(self, chance: random.Random) -> tuple[int, int]:
        """Nearly always in the window."""
        width, height = self._app.size
        if chance.random() < 0.02:
            return chance.choice(((-1, 0), (width, height), (width + 50, 3), (2, -7)))
        return chance.randrange(max(1, width)), chance.randrange(max(1, height))

    def _mouse(self, kind: type[events.MouseEvent], at: tuple[int, int], button: int = 1) -> str:
        x, y = at
        self._tell(kind(None, x, y, 0, 0, button, False, False, False, x, y))
        return f"{kind.__name__} {x},{y} button {button}"

    def _move(self, chance: random.Random) -> str:
        button = int(self._is_down and chance.random() < 0.9)
        return self._mouse(events.MouseMove, self._at(chance), button)

    def _down(self, chance: random.Random) -> str:
        self._is_down = True
        return self._mouse(events.MouseDown, self._at(chance), chance.choice((1, 1, 1, 2, 3)))

    def _up(self, chance: random.Random) -> str:
        self._is_down = False
        return self._mouse(events.MouseUp, self._at(chance))

    def _click(self, chance: random.Random) -> str:
        at = self._at(chance)
        self._mouse(events.MouseDown, at)
        self._is_down = False
        return f"click: {self._mouse(events.MouseUp, at)}"

    def _scroll(self, chance: random.Random) -> str:
        kind = chance.choice((events.MouseScrollUp, events.MouseScrollDown))
        return self._mouse(kind, self._at(chance), 0)

    def _on_pad(self, chance: random.Random) -> tuple[int, int]:
        """On a button of the pad, where there is one."""
        nth, buttons = chance.random(), []
        if self._app.screen_stack:
            buttons = [b for b in self._app.screen.query(JogButton) if b.region.area]
        if not buttons:
            return self._at(chance)
        region = buttons[int(nth * len(buttons))].region
        return region.x + 1, region.y

    def _pad(self, chance: random.Random) -> str:
        """It is pressed, and held; the next thing may come soon or late."""
        self._is_down = True
        return f"pad: {self._mouse(events.MouseDown, self._on_pad(chance))}"

    def _leave_window(self, chance: random.Random) -> str:
        """Pressed, and out of the window: where the button is let go nobody hears."""
        at = self._on_pad(chance)
        self._mouse(events.MouseDown, at)
        self._is_down = True
        width, height = self._app.size
        out = chance.choice(((-1, at[1]), (width, at[1]), (at[0], -1), (at[0], height)))
        if chance.random() < 0.5:
            self._mouse(events.MouseMove, out)
        return f"pad left: {at} to {out}"

    # --- the terminal ----------------------------------------------------------------------------

    def _resize(self, chance: random.Random) -> str:
        # Large ones take long to draw.
        width, height = chance.choice(((120, 40), (120, 40), (120, 40), (300, 100)))
        size = Size(chance.randint(20, width), chance.randint(5, height))
        self._app._driver._size = size  # type: ignore[union-attr]
        self._tell(events.Resize(size, size))
        return f"size {size.width}x{size.height}"

    def _paste(self, chance: random.Random) -> str:
        text = chance.choice(_WORDS) * chance.choice((1, 1, 3, 500)) + chance.choice(
            ("", "\n", "\x00")
        )
        self._tell(events.Paste(text))
        return f"paste of {len(text)}: {text[:20]!r}"

    def _focus(self, chance: random.Random) -> str:
        kind = chance.choice((events.AppBlur, events.AppFocus))
        self._tell(kind())
        return kind.__name__
