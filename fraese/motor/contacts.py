r"""The end switches of a simulated mill: all in parallel on one line.

    pressed    ____/~~~~~~~~~~~~~~\____________
    closed     ________/~~~~~~~~~~~~~~\________     lag after each change
    reading    ________|_|~~~~~~~~~~~~|~|______     bounces, counted in readings

Rule 1: the line closes some time after the carriage got to a switch, and opens as much after it
        left the last one.
Rule 2: after a change some readings alternate between new and old; the last of them is old.
Rule 3: while nothing is on its way, the line need not be worked out for every reading.
"""

from typing import Final

from fraese.motor.seams import End

_NS_PER_S: Final = 1_000_000_000


class Contacts:
    """All end switches in parallel on one line, with lag and bounce.

    Args:
        lag_s: from the carriage's arrival to the contact, and likewise for leaving.
        bounce_readings: readings after a change that alternate between new and old.

    Attributes:
        closed: the line, when it has stopped bouncing.
        still: nothing is on its way; ``closed`` is the reading.
    """

    def __init__(self, lag_s: float, bounce_readings: int) -> None:
        self._lag_ns = round(lag_s * _NS_PER_S)
        self._bounce_readings = bounce_readings
        self._pressed: dict[End, int] = {}
        self._leaving_until_ns = 0
        self.closed = False
        self._bouncing = 0
        self.still = True

    @property
    def any_pressed(self) -> bool:
        """Some switch is held down."""
        return bool(self._pressed)

    def pressed(self) -> frozenset[End]:
        """Switches that are held down now."""
        return frozenset(self._pressed)

    def change(self, end: End, pressed: bool, now_ns: int) -> None:
        """A switch is pressed or let go."""
        if pressed == (end in self._pressed):
            return
        self.still = False
        if pressed:
            self._pressed[end] = now_ns
        else:
            del self._pressed[end]
            self._leaving_until_ns = now_ns + self._lag_ns

    def read(self, now_ns: int) -> bool:
        """One reading of the line."""
        arrived = any(now_ns - since >= self._lag_ns for since in self._pressed.values())
        closed = arrived or now_ns < self._leaving_until_ns
        if closed != self.closed:
            self.closed = closed
            self._bouncing = self._bounce_readings
        reading = self.closed
        if self._bouncing:
            # New and old in turn; the last one that bounces is old.
            reading ^= self._bouncing % 2 == 1
            self._bouncing -= 1
        settled = all(now_ns - since >= self._lag_ns for since in self._pressed.values())
        self.still = settled and not self._bouncing and now_ns >= self._leaving_until_ns
        return reading
