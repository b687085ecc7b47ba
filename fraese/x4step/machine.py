"""``X4Step``: four motors at one port, the class behind the sixteen functions."""

from collections.abc import Iterable, Sequence
from operator import index
from types import TracebackType
from typing import Final, Self

from fraese.log import logged
from fraese.motor.clock import MonotonicClock
from fraese.motor.pins import STATUS_PINS
from fraese.x4step import lifeline, surroundings, verdicts
from fraese.x4step.codes import (
    AXES,
    ESC_CODE,
    LPT1,
    MOST_CODES,
    PORTS,
    SIGNALS,
    X4ErrIsActive,
    X4ErrParamFail,
    X4Failure,
    X4NoErr,
)
from fraese.x4step.complaints import complain
from fraese.x4step.lpt import Opened
from fraese.x4step.motion import Motion
from fraese.x4step.owner import Facts, Owner, ThreadedOwner
from fraese.x4step.paths import endless, path
from fraese.x4step.surroundings import Surroundings
from fraese.x4step.verdicts import Asked, Rows

#: Bits of the status register that are turned round at the plug.
_INVERTED: Final = sum(line.bit for line in STATUS_PINS.values() if line.inverted)
#: What X4SetOut switches: bit of a driver's outputs, and its value.
_SWITCHES: Final = {
    signal: (1 << number // 2, number % 2 == 0) for number, signal in enumerate(SIGNALS)
}
#: A scan code is a byte; C's char may have a sign.
_SCAN_CODES: Final = range(-128, 256)

Load = tuple[tuple[int, ...], int, int]


class X4Step:
    """Four stepper motors at a parallel port.

    Steps are made in the background: every method returns at once, except ``wait`` and ``close``.

        with X4Step(2) as motors:
            motors.load((1000, 500), 2000, 50)
            motors.start()
            motors.wait()

    Args:
        lpt: 1 to 4.
        around: what it is opened in; None: as configured.

    Raises:
        X4Failure: 8 for a number that is no port.
        PortError: if the port is not there, forbidden, or somebody else has it.
        ConfigError: if the configuration is wrong.
    """

    def __init__(self, lpt: int = LPT1, around: Surroundings | None = None) -> None:
        lpt = index(lpt)
        if lpt not in PORTS:
            raise X4Failure(X4ErrParamFail)
        around = around or surroundings.present()
        self._loaded: Load | None = None
        self._closed = False
        self._opened: Opened = around.open(lpt)
        self._clock = self._opened.clock
        self._cleared_ns = self._clock.now_ns()
        try:
            self._owner = self._owned(around)
        except BaseException:
            self._opened.driver.close()
            self._opened.let_go(complain)
            raise
        self.brake_codes(())
        lifeline.hold(self)

    def _owned(self, around: Surroundings) -> Owner:
        motion, reader = Motion(self._opened.driver), around.keyboard.reader()
        # A port on the machine's own clock does not wait for anybody.
        if around.is_lockstep and not isinstance(self._clock, MonotonicClock):
            return Owner(motion, self._clock, reader, complain)
        opened = self._opened
        return ThreadedOwner(motion, self._clock, reader, complain, opened.slice_s, opened.idle_s)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    # --- moving ----------------------------------------------------------------------------------

    @logged
    def load(self, steps: Sequence[int], freq_hz: int, ramp_ms: int) -> None:
        """Load a path, to be started later; also while axes move (X4Load).

        Args:
            steps: signed steps of axes 1 to 4; missing ones stand.
            freq_hz: rate of the axis with most steps, 10 to 20,000.
            ramp_ms: time of each ramp, 0 to 1000, not above the rate.

        Raises:
            X4Failure: 12, 2, 3, 4, 8, 5, 1 or 13; nothing was loaded, what was loaded stays.
        """
        way = tuple(index(n) for n in steps)
        way += (0,) * (len(AXES) - len(way))
        freq_hz, ramp_ms = index(freq_hz), index(ramp_ms)
        self._require(verdicts.LOAD, Asked(freq_hz=freq_hz, ramp_ms=ramp_ms, steps=way))
        if len(way) != len(AXES):
            raise X4Failure(X4ErrParamFail)
        self._loaded = (way, freq_hz, ramp_ms)

    @logged
    def start(self) -> None:
        """Start what was loaded; it is used up by that (X4Start).

        Raises:
            X4Failure: 10 or 11.
            PortError: if the port was lost; what was loaded stays.
        """
        self._require(verdicts.START)
        assert self._loaded is not None
        way, freq_hz, ramp_ms = self._loaded
        self._owner.start(path(way, freq_hz, ramp_ms))
        self._loaded = None

    def move_positive(self, axis: int, freq_hz: int, ramp_ms: int) -> None:
        """Move one axis until it is braked or stopped (X4MovePos).

        Args:
            axis: 1 to 4.
            freq_hz: its rate, 10 to 20,000.
            ramp_ms: time of the ramps, 0 to 1000, not above the rate.

        Raises:
            X4Failure: 10, 12, 8, 2, 3, 4 or 5.
            PortError: if the port was lost.
        """
        self._move(axis, 1, freq_hz, ramp_ms)

    def move_negative(self, axis: int, freq_hz: int, ramp_ms: int) -> None:
        """The same in negative direction (X4MoveNeg)."""
        self._move(axis, -1, freq_hz, ramp_ms)

    @logged
    def _move(self, axis: int, sign: int, freq_hz: int, ramp_ms: int) -> None:
        axis, freq_hz, ramp_ms = index(axis), index(freq_hz), index(ramp_ms)
        self._require(verdicts.MOVE, Asked(axis=axis, freq_hz=freq_hz, ramp_ms=ramp_ms))
        self._owner.start(endless(AXES.index(axis), sign, freq_hz, ramp_ms, len(AXES)))

    @logged
    def brake(self) -> None:
        """Brake along the ramp of the present path (X4Brake).

        Raises:
            X4Failure: 7, if no axis moves.
        """
        if self._closed or not self._owner.brake():
            raise X4Failure(verdicts.verdict(verdicts.BRAKE, Asked(ready=True)))

    @logged
    def stop(self) -> None:
        """Stop at once, without a ramp: the motors may turn on uncounted (X4Stop).

        Raises:
            X4Failure: 7, if no axis moves.
        """
        if self._closed or not self._owner.stop():
            raise X4Failure(verdicts.verdict(verdicts.BRAKE, Asked(ready=True)))

    def wait(self) -> None:
        """Until all axes stand."""
        while self._owner.ask("wait").moving:
            pass

    # --- asking ----------------------------------------------------------------------------------

    @property
    def moving(self) -> bool:
        """One or more axes move: the level of ACTIVE (X4GetState)."""
        return self._owner.ask("moving").moving

    def steps(self, axis: int) -> int:
        """Signed steps since the last start; 0 for an axis that is none (X4GetSteps)."""
        axis = index(axis)
        facts = self._owner.ask(("steps", axis))
        return facts.steps[AXES.index(axis)] if axis in AXES else 0

    @property
    def facts(self) -> Facts:
        """All facts of one moment; no time passes for it."""
        return self._owner.facts

    @property
    def timer_ms(self) -> int:
        """Whole milliseconds since the timer was cleared, in the port's time (X4GetTimer)."""
        self._owner.ask("timer")
        return (self._clock.now_ns() - self._cleared_ns) // 1_000_000

    def clear_timer(self) -> None:
        """Count from 0 again (X4ClearTimer)."""
        self._owner.forget("timer")
        self._cleared_ns = self._clock.now_ns()

    @property
    def inputs(self) -> int:
        """Levels of the inputs: bits 4 to 0 are pins 11, 10, 12, 13, 15; 1 is high (X4GetIn)."""
        status = self._owner.ask("inputs").inputs
        return (status ^ _INVERTED) >> 3 & 0b11111

    def pass_time(self, seconds: float) -> None:
        """Let so much of the port's time pass; on a paced or real clock, sleep."""
        self._owner.pass_time(seconds)

    # --- keys and signals ------------------------------------------------------------------------

    def brake_codes(self, codes: Iterable[int] | str) -> None:
        """Keys that brake, besides ESC (X4BrakeCodes).

        Args:
            codes: up to 20 scan codes; a 0 ends them. They hold until others are named.

        Raises:
            X4Failure: 8 for more of them, or one that is no byte; the old ones stay.
        """
        named: list[int] = []
        if isinstance(codes, str):
            codes = codes.encode("latin-1", "replace")
        for code in map(index, codes):
            if not code:
                break
            if code not in _SCAN_CODES or len(named) == MOST_CODES:
                raise X4Failure(X4ErrParamFail)
            named.append(code & 0xFF)
        self._owner.brake_codes = frozenset((ESC_CODE, *named))

    @property
    def last_brake_code(self) -> int:
        """Scan code that ended the last motion; 0 if no key did (X4LastBrakeCode)."""
        return self._owner.ask("code").brake_code

    @logged
    def set_output(self, signal: int) -> None:
        """Switch a free signal: 1 and 2 for signal 1 on and off, 3 and 4 for signal 2 (X4SetOut).

        Raises:
            X4Failure: 8 for any other number.
            PortError: if the port was lost.
        """
        signal = index(signal)
        self._require(verdicts.SET_OUT, Asked(signal=signal))
        mask, on = _SWITCHES[signal]
        self._owner.do(lambda: self._opened.driver.set_outputs(mask, mask if on else 0))

    # --- the end ---------------------------------------------------------------------------------

    @logged
    def close(self) -> None:
        """Brake if axes move, wait for that; then all lines low, the port given back (X4ReInit).

        Safe to call twice.

        Raises:
            PortError: if the motors could not be switched off.
        """
        if self._closed:
            return
        try:
            if self._owner.brake():
                self.wait()
        except BaseException:
            self._owner.stop()
            raise
        finally:
            self._closed = True
            lifeline.let_go(self)
            self._owner.close()
            self._loaded = None
            try:
                self._opened.driver.close()
            finally:
                self._opened.let_go(complain)

    @property
    def is_open(self) -> bool:
        """It was not closed yet."""
        return not self._closed

    def require_standstill(self) -> None:
        """Refuse while axes move.

        Raises:
            X4Failure: 10.
        """
        if self._owner.motion.moving:
            raise X4Failure(X4ErrIsActive)

    def _require(self, rows: Rows, asked: Asked = Asked()) -> None:  # noqa: B008 (immutable)
        state = asked._replace(
            ready=not self._closed,
            moving=not self._closed and self._owner.facts.moving,
            loaded=self._loaded is not None,
        )
        code = verdicts.verdict(rows, state)
        if code is not X4NoErr:
            raise X4Failure(code)
