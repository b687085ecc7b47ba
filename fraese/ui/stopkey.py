"""The stop key does not wait until something is drawn.

    terminal --bytes--> input thread --> message queue --> app's thread: action
                             '--> brake, at once

Drawing takes the app's thread up to some 15 ms at a time, and a key waits for it. The stop key is
therefore seen where Textual reads the terminal, in a thread of its own; the same key comes to the
action later and brakes once more: what was pressed before it, and waited too, must not move.
"""

from collections.abc import Callable, Collection
from typing import NamedTuple

from textual.driver import Driver
from textual.events import Key
from textual.message import Message


class Heard(NamedTuple):
    """A stop key that has already braked.

    Attributes:
        key: the event, which is still on its way.
        moving: the machine moved when it was pressed.
    """

    key: Key
    moving: bool


class EarlyStop:
    """What the input thread did, for when the app's thread gets there.

    Args:
        keys: names of the stop keys.
        act: brakes; returns whether the machine moved. Called in the input thread.
    """

    def __init__(self, keys: Collection[str], act: Callable[[], bool]) -> None:
        self._keys = keys
        self._act = act
        self._heard: list[Heard] = []

    def driver(self, driver: type[Driver]) -> type[Driver]:
        """A terminal driver of that kind that tells of stop keys first."""

        def process_message(terminal: Driver, message: Message) -> None:
            if isinstance(message, Key) and message.key in self._keys:
                self._heard.append(Heard(message, self._act()))
            driver.process_message(terminal, message)

        return type(driver.__name__, (driver,), {"process_message": process_message})

    def of(self, key: Key) -> Heard | None:
        """What was done about this very event; None: nothing yet. Ask once."""
        for heard in self._heard:
            if heard.key is key:
                self._heard.remove(heard)
                return heard
        return None
