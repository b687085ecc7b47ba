r"""How far the motors may go on before they must brake, if nothing more comes.

    v^2 ^      plan
        |   ____________________________ ....  end of what is queued, at speed
        |  /                       \
        | /                         \  braking that fits into the rest of the queue
        |/                           \
        +--------------------------X--|--> ticks       X: the dry point

Rule 1: a block is final, so the point can be known when it is pushed; a player has nothing to
        compute, it compares a count. Only the point of the block pushed last counts.
Rule 2: path energy is ``weight * rate**2``, one unit for all blocks; one tick of braking sheds
        ``weight * 2 * acceleration``. What must be shed is that of the plan; a throttled run is
        slower and stops sooner.
Rule 3: a queue whose last block ends at rest has no dry point: its own plan stops there.
Rule 4: the throttle moves in slices and lags by up to two of them, at low rates by some ticks:
        braking begins that much early.
"""

from collections import deque
from typing import Final, NamedTuple

from fraese.blocks import CYCLES_PER_S, Q8, Block
from fraese.motor.throttle import SLICE_CYCLES

_UNITS_PER_S: Final = float(CYCLES_PER_S * Q8)
_RESERVE_Q8: Final = 2 * SLICE_CYCLES * Q8
_RESERVE_TICKS: Final = 8
#: Squared rate, in (tick/s)**2, that one tick of braking sheds per unit of ``accel_q``.
_SHED_PER_TICK: Final = 2 * CYCLES_PER_S / 256 / 65536


class DryPoint(NamedTuple):
    """Where braking must begin: in this block, when so many of its ticks are done, or later."""

    serial: int
    ticks_done: int

    def moved(self, by: int) -> "DryPoint":
        """The same point for one who counts the blocks from another one on."""
        return DryPoint(self.serial + by, self.ticks_done)


class _Ahead(NamedTuple):
    """A block that does not end at rest, and what can be shed in it and in all before it."""

    serial: int
    block: Block
    ticks: int
    shed_per_tick: float
    shed_so_far: float


class Horizon:
    """Finds the dry point of every block that is pushed."""

    def __init__(self) -> None:
        self._ahead: deque[_Ahead] = deque()
        self._shed = 0.0

    def reset(self) -> None:
        """The queue was dropped."""
        self._ahead.clear()
        self._shed = 0.0

    def add(self, serial: int, block: Block) -> DryPoint | None:
        """Where to brake if this block, the serial-th, stays the last one; None: nowhere."""
        if block.ends_at_rest or not any(block.steps):
            self.reset()
            return None
        ticks = block.ticks()
        per_tick = block.weight * block.accel_q * _SHED_PER_TICK
        self._shed += per_tick * ticks
        self._ahead.append(_Ahead(serial, block, ticks, per_tick, self._shed))
        # The point never moves back: what lies before it can be forgotten.
        while len(self._ahead) > 1 and not self._is_late(self._ahead[1], 0, None):
            self._ahead.popleft()
        first = self._ahead[0]
        return DryPoint(first.serial, self._first_late_tick(first))

    def _is_late(self, ahead: _Ahead, done: int, interval_q8: int | None) -> bool:
        """Braking no longer suffices when so many ticks of a block are done as planned."""
        block = ahead.block
        if interval_q8 is None:
            interval_q8 = next(piece.interval_q8 for piece in block.pieces if piece.ticks)
        rate_hz = _UNITS_PER_S / interval_q8
        jump_hz = block.jump_rate_q8 / Q8
        left = ahead.ticks - done - _RESERVE_Q8 // interval_q8 - _RESERVE_TICKS
        shed = ahead.shed_per_tick * left + self._shed - ahead.shed_so_far
        return block.weight * (rate_hz * rate_hz - jump_hz * jump_hz) > shed

    def _first_late_tick(self, ahead: _Ahead) -> int:
        """The first count of ticks done from which on braking would be too late."""
        if self._is_late(ahead, 0, None):
            return 0
        before = 0
        for piece in ahead.block.pieces:
            if piece.ticks and self._is_late(ahead, before + piece.ticks, piece.last_interval_q8()):
                low, high = 0, piece.ticks
                while high - low > 1:
                    middle = (low + high) // 2
                    at_q8 = piece.interval_q8 + (middle - 1) * piece.add_q8
                    if self._is_late(ahead, before + middle, at_q8):
                        high = middle
                    else:
                        low = middle
                return before + high
            before += piece.ticks
        return ahead.ticks
