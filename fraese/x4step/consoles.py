"""Where the test program is spoken with: a terminal, or a script."""

from collections.abc import Callable
from typing import Final, TextIO

from fraese.x4step.codes import ESC_CODE
from fraese.x4step.keys import HandKeys, Keyboard

_ESC: Final = "\x1b"
#: When a script's ESC comes, ms after its command began.
_ESC_MS: Final = 1000

Say = Callable[[str], None]


class TerminalConsole:
    """A person at a terminal.

    Args:
        keyboard: its keys.
        lines: where lines come from.
        say: takes a line for the screen.
        prompt: takes what the line begins with.
    """

    def __init__(self, keyboard: Keyboard, lines: TextIO, say: Say, prompt: Say) -> None:
        self._keyboard = keyboard
        self._lines = lines
        self.say = say
        self._prompt = prompt

    def line(self, prompt: str) -> str | None:
        """The next command; None: there is no more."""
        self._prompt(prompt)
        line = self._keyboard.source.line_ahead()
        if not line.endswith("\n"):
            line += self._lines.readline()
        # ESC ends a motion; where none goes on it is no part of a command.
        return line.replace(_ESC, "") or None

    def code(self) -> int | None:
        """Make code of the next key, if one waits."""
        try:
            return self._keyboard.getch().code if self._keyboard.kbhit() else None
        except EOFError:
            return ESC_CODE

    def escaped(self) -> bool:
        """ESC was pressed between two motions; other keys are left where they are."""
        return self._keyboard.source.skip(ESC_CODE)

    def press_if_due(self, elapsed_ms: int, only_esc_ends: bool) -> bool:
        """A person presses keys as they like."""
        return False


class ScriptConsole:
    """A file or a pipe.

    Args:
        text: all of it.
        say: takes a line of output.
        prompt: takes a prompt.

    Attributes:
        keys: what the script presses.
    """

    def __init__(self, text: str, say: Say, prompt: Say) -> None:
        self._rest = text
        self.say = say
        self._prompt = prompt
        self.keys = HandKeys()

    def line(self, prompt: str) -> str | None:
        """The next command; None: there is no more."""
        self._rest = self._rest.lstrip(_ESC)
        if not self._rest:
            return None
        self._prompt(prompt)
        line, _, self._rest = self._rest.partition("\n")
        self.say(line)
        return line

    def code(self) -> int | None:
        """No key waits."""
        return None

    def escaped(self) -> bool:
        """A script presses keys while something moves."""
        return False

    def press_if_due(self, elapsed_ms: int, only_esc_ends: bool) -> bool:
        """ESC, when its time has come: if the script has one here, or nothing else ends this."""
        wanted = only_esc_ends or self._rest.startswith(_ESC)
        if not wanted or elapsed_ms < _ESC_MS:
            return False
        self._rest = self._rest.removeprefix(_ESC)
        self.keys.press(ESC_CODE)
        return True
