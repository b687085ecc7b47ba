"""What has happened while the app was there: the events that the view Log shows."""

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from datetime import datetime
from enum import Enum
from typing import Final

from fraese.phrases import shown, spoken

#: Older ones are forgotten: an app that stands for weeks must not fill the memory.
MOST_EVENTS: Final = 2000


class Kind(Enum):
    """What sort of event it is."""

    ALARM = "alarm"
    WARNING = "warning"
    SAID = "said"


@dataclass(frozen=True, slots=True)
class Event:
    """One event, or the same one several times in a row.

    Attributes:
        at: when it was last.
        kind: of which sort.
        text: in words.
        times: how often.
        number: of an alarm; 0: none.
        advice: what to do now; empty: the text says it.
    """

    at: datetime
    kind: Kind
    text: str
    times: int = 1
    number: int = 0
    advice: str = ""

    @property
    def title(self) -> str:
        """The text, with the number of an alarm before it and how often behind it."""
        number = spoken("Alarm {number}: ", number=self.number) if self.number else ""
        return number + shown(self.text) + (f"  ×{self.times}" if self.times > 1 else "")


class EventLog:
    """Events, the oldest first.

    Args:
        now: tells the time.
    """

    def __init__(self, now: Callable[[], datetime] = datetime.now) -> None:
        self._now = now
        self._events: list[Event] = []
        self._forgotten = 0

    @property
    def events(self) -> tuple[Event, ...]:
        """All that are remembered."""
        return tuple(self._events)

    def of(self, kinds: Collection[Kind]) -> tuple[Event, ...]:
        """Those of some kinds."""
        return tuple(event for event in self._events if event.kind in kinds)

    @property
    def version(self) -> tuple[int, int]:
        """Another one when something was added."""
        last = self._events[-1].times if self._events else 0
        return self._forgotten + len(self._events), last

    def add(self, text: str, kind: Kind = Kind.SAID, number: int = 0, advice: str = "") -> None:
        """Something has happened."""
        event = Event(self._now(), kind, text, number=number, advice=advice)
        last = self._events[-1] if self._events else None
        if last is not None and replace(event, at=last.at, times=last.times) == last:
            self._events[-1] = replace(event, times=last.times + 1)
            return
        self._events.append(event)
        if len(self._events) > MOST_EVENTS:
            del self._events[0]
            self._forgotten += 1
