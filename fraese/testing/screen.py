"""An app without a terminal that plain functions drive: keys in, letters out.

    test --order--> queue --> task with the app's loop --> result

Rule 1: the app's loop runs only while somebody waits for an order, in the thread that waits: what a
        test looks at stands still meanwhile. The machine's thread goes on.
Rule 2: an app that has failed says so at the next order.
"""

import asyncio
import io
import string
import unicodedata
from collections.abc import Callable, Coroutine
from pathlib import Path
from typing import Any, Final, TypeVar

from rich.console import Console
from textual.events import Key
from textual.keys import REPLACED_KEYS, Keys, _character_to_key, _get_unicode_name_from_key
from textual.pilot import Pilot

from fraese.testing.failures import HasEnded, NoSuchName
from fraese.testing.patience import Patience
from fraese.ui.app import FraeseApp

_T = TypeVar("_T")
#: A key is heard, and what follows from it is on its way.
_HEARD_S: Final = 0.02
#: Names of keys that are no characters, without Ctrl, Alt and Shift; letters go with those.
_NAMED: Final = frozenset(
    key.value for key in Keys if key.value.isalnum() and "+" not in key.value
) | frozenset(string.ascii_lowercase)
#: So often in a row it must be so.
_HELD: Final = 2
#: Between two looks at what is waited for.
_LOOK_S: Final = 0.01


class Screen:
    """The app on a screen of letters.

    Args:
        app: started here, ended by ``close``.
        size: columns and lines.
    """

    def __init__(self, app: FraeseApp, size: tuple[int, int]) -> None:
        self.app = app
        self._loop = asyncio.new_event_loop()
        self._orders: asyncio.Queue[Callable[[], Coroutine[Any, Any, None]] | None]
        self._orders = asyncio.Queue()
        self._task = self._loop.create_task(self._live(size))
        self._pilot: Pilot[None] | None = None
        self.wait("the app to start", lambda: True)

    async def _live(self, size: tuple[int, int]) -> None:
        async with self.app.run_test(size=size) as pilot:
            self._pilot = pilot
            while (order := await self._orders.get()) is not None:
                await order()

    def close(self) -> None:
        """Leave the app; what it failed with is raised."""
        self._orders.put_nowait(None)
        try:
            self._loop.run_until_complete(self._task)
        finally:
            self._loop.run_until_complete(self._loop.shutdown_asyncgens())
            self._loop.run_until_complete(self._loop.shutdown_default_executor())
            self._loop.close()

    def _do(self, order: Callable[[], Coroutine[Any, Any, _T]]) -> _T:
        """Carry an order out in the app's task."""
        done: asyncio.Future[_T] = self._loop.create_future()

        async def carried_out() -> None:
            try:
                done.set_result(await order())
            except BaseException as error:
                done.set_exception(error)

        self._orders.put_nowait(carried_out)
        both: set[asyncio.Future[Any]] = {done, self._task}
        either = asyncio.wait(both, return_when=asyncio.FIRST_COMPLETED)
        self._loop.run_until_complete(either)
        if not done.done():
            # The app has ended before: what ended it is the news.
            self._task.result()
        return done.result()

    def _in_app(self, action: Callable[[], object]) -> None:
        """Where the app knows itself; what is waited for may look at it, too."""

        async def carried_out() -> None:
            action()

        if self._loop.is_running():
            action()
        else:
            self._do(carried_out)

    # --- in -------------------------------------------------------------------------------------

    def press(self, key: str) -> None:
        """One key, by its name or its character."""
        self._do(lambda: self._press(key))

    async def _press(self, key: str) -> None:
        if not self.app.is_running:
            raise HasEnded
        name = _character_to_key(key) if len(key) == 1 and not key.isalnum() else key
        original = REPLACED_KEYS.get(name, name)
        character: str | None
        try:
            character = unicodedata.lookup(_get_unicode_name_from_key(original))
        except KeyError:
            character = key if len(key) == 1 else None
            if character is None and name.rpartition("+")[2] not in _NAMED:
                raise NoSuchName(key, ("a character", *sorted(_NAMED))) from None
        driver = self.app._driver
        assert driver is not None
        # As the terminal's driver does it: a stop key is heard there first.
        driver.process_message(Key(original, character))
        await asyncio.sleep(_HEARD_S)
        await self._drawn()

    async def _drawn(self) -> None:
        """What was posted has been done, and what that has posted: app, screen, widget, action."""
        for _ in range(3):
            if self._pilot is not None and self.app.is_running:
                await self._pilot.pause(0)

    def wait(self, what: str, condition: Callable[[], bool]) -> None:
        """Let the app live until this holds.

        Raises:
            TookTooLong: it does not, in a minute of real time.
        """

        async def until() -> None:
            patience, held = Patience(f"waiting for {what}"), 0
            # Seen twice: what a key has set off may be on its way from one thread to another.
            while held < _HELD:
                held = held + 1 if condition() else 0
                patience.require()
                await asyncio.sleep(_LOOK_S)
                await self._drawn()

        self._do(until)

    # --- out ------------------------------------------------------------------------------------

    def text(self) -> str:
        """What is on the screen, in letters, line by line."""
        app, size = self.app, self.app.size
        console = Console(
            width=size.width, height=size.height, file=io.StringIO(), force_terminal=True,
            color_system="truecolor", record=True, legacy_windows=False, safe_box=False,
        )  # fmt: skip

        def drawn() -> None:
            console.print(
                app.screen._compositor.render_update(
                    full=True, screen_stack=app._background_screens, simplify=False
                )
            )

        self._in_app(drawn)
        rows = console.export_text(styles=False).split("\n")[: size.height]
        return "\n".join(row.rstrip() for row in rows)

    def picture(self, path: Path) -> None:
        """Keep a picture of the screen, as SVG."""
        self._in_app(lambda: path.write_text(self.app.export_screenshot(), "utf-8"))
