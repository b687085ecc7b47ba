"""The app on a simulated machine in virtual time: keys typed, the screen read.

    app.press("r", "enter")          referenced, when it returns
    app.freeze_at(1.5)               time stands still in the next job, 1.5 s after its start
    app.press("s", "enter", "escape")
    app.settled()                    time goes on, to the end of it

Rule 1: keys are heard by the app; the machine runs in a thread of its own, as fast as it can.
Rule 2: a press comes back when the machine has come to rest, or waits: for an answer, in a hold, or
        where time was frozen; and no program is being read or looked through.
Rule 3: nothing of the person at the computer is read or written: the configuration is a copy, and
        the state lies beside it.
"""

import tempfile
import threading
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Any, Final, Self

from fraese.assembly import Plant, assemble
from fraese.cli.shared import Drive
from fraese.cli.theapp import make_app
from fraese.config.file import load
from fraese.testing.failures import DrivenByKeys, TookTooLong
from fraese.testing.hands import Configuration, Hands, configured, written
from fraese.testing.mill import LIMIT_S
from fraese.testing.screen import Screen

_NS_PER_S: Final = 1_000_000_000
#: What is done by keys here.
_COMMANDS: Final = frozenset({"home", "move", "jog", "zero", "run", "check", "acknowledge"})


class Onlooker(Hands):
    """Sees and touches the machine behind the app; keys command it."""

    def __getattr__(self, name: str) -> Any:
        if name in _COMMANDS:
            raise DrivenByKeys(name)
        raise AttributeError(name)


class Time:
    """Machine time of the app's jobs: how long they may take, and where it stands still.

    Args:
        plant: whose.
        limit_s: machine time that a job may take.
    """

    def __init__(self, plant: Plant, limit_s: float) -> None:
        self._controller, self._clock = plant.controller, plant.clock
        self._limit_s = limit_s
        self._began_ns: int | None = None
        self._at_s: float | None = None
        self._frozen = threading.Event()
        self._goes_on = threading.Event()
        self._too_long = ""
        self._between = self._controller._loop._break_key
        self._controller.set_break_key(self.between)

    @property
    def is_frozen(self) -> bool:
        """Somebody has stopped it."""
        return self._frozen.is_set() and not self._goes_on.is_set()

    def freeze_at(self, seconds: float) -> None:
        """In the next job, so long after its start."""
        self._goes_on.clear()
        self._at_s = seconds

    def go_on(self) -> None:
        """It passes again."""
        self._at_s = None
        self._goes_on.set()

    def require(self) -> None:
        """Nothing took too long.

        Raises:
            TookTooLong: it did, and was cancelled.
        """
        told, self._too_long = self._too_long, ""
        if told:
            raise TookTooLong(told, self._limit_s)

    def between(self) -> None:
        """Between two slices of a job, in the machine's thread."""
        progress = self._controller.state().job
        passed_s = progress.elapsed_s if progress else 0.0
        if self._at_s is not None and passed_s >= self._at_s:
            self._at_s = None
            # What is drawn meanwhile is how it stands now.
            self._controller._loop._show_pos()
            self._frozen.set()
            self._goes_on.wait()
            self._frozen.clear()
        if passed_s > self._limit_s and not self._too_long:
            self._too_long = progress.name if progress else "the job"
            self._controller.cancel()
        self._between()


class App:
    """The app, driven by keys.

    Args:
        configuration: see ``hands.configured``.
        size: columns and lines of its terminal.
        folder: where its files lie; None: in one that is gone afterwards.
        program: to open at the start.
        limit_s: machine time that a job may take.

    Attributes:
        mill: the machine, to be seen and touched.
        folder: likewise.
        ui: the Textual app.

    Raises:
        ConfigError: one sentence with the key and what would be right.
    """

    def __init__(
        self,
        configuration: Configuration = None,
        *,
        size: tuple[int, int] = (80, 24),
        folder: Path | None = None,
        program: Path | None = None,
        limit_s: float = LIMIT_S,
    ) -> None:
        self._own = None if folder else tempfile.TemporaryDirectory(prefix="fraese-app-")
        self.folder = folder or Path(self._own.name if self._own else ".")
        file, state = self.folder / "fraese.toml", self.folder / "state"
        # In our own words first: what is wrong with it is said of the test's, not of the copy.
        configured(configuration)
        file.write_text(written(configuration), "utf-8")
        self._plant = assemble(load(file), state=state)
        self.mill = Onlooker(self._plant)
        self.ui = make_app(self._plant, program, Drive(config=file, state=state))
        self._time = Time(self._plant, limit_s)
        self._screen = Screen(self.ui, size)
        self.settled()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Leave it: motors off, as by its own key."""
        self._time.go_on()
        try:
            self._screen.close()
        finally:
            self._plant.close()
            if self._own is not None:
                self._own.cleanup()

    # --- in ------------------------------------------------------------------------------------

    def press(self, *keys: str) -> None:
        """Press keys, one after the other; each has been carried out when the next one comes.

        Args:
            keys: by name, as ``fraese config keys`` lists them ("right", "f3", "ctrl+c"), or a
                character.

        Raises:
            TookTooLong: the machine did not come to rest.
        """
        for key in keys:
            self._screen.press(key)
            self._rest()

    def type(self, text: str) -> None:
        """Press the keys of a text, one after the other."""
        for character in text:
            self._screen.press("space" if character == " " else character)
        self._rest()

    def settled(self) -> None:
        """Wait until the machine has come to rest, or waits for somebody; frozen time goes on.

        Raises:
            TookTooLong: it did not.
        """
        self._time.go_on()
        self._rest()

    def wait(self, condition: Callable[[], bool], what: str = "what was asked for") -> None:
        """Let app and machine go on until this holds.

        Raises:
            TookTooLong: it does not, in a minute of real time.
        """
        self._screen.wait(what, condition)

    def freeze_at(self, seconds: float) -> None:
        """In the next job, let machine time stand still so long after its start, to 0.1 s.

        Keys are heard meanwhile, and the machine can be touched; ``settled`` lets it go on.
        """
        self._time.freeze_at(seconds)

    # --- out -----------------------------------------------------------------------------------

    @property
    def text(self) -> str:
        """What is on the screen, line by line."""
        return self._screen.text()

    @property
    def question(self) -> str:
        """What the job asks now; empty: nothing."""
        return self._plant.controller.question

    def picture(self, path: Path) -> None:
        """Keep a picture of the screen, as SVG."""
        self._screen.picture(path)

    def _rest(self) -> None:
        self._screen.wait("the machine to come to rest", self._rests)
        self._time.require()

    def _rests(self) -> bool:
        controller, state = self._plant.controller, self._plant.controller.state()
        waits = self._time.is_frozen or state.question or (controller.holding and state.held)
        # No file is read or looked through beside it, and it is drawn.
        done = bool(waits or not self.ui.busy) and self.ui._programs.look is None
        return done and state == self.ui._state
