"""The bridge: the real firmware in the simulated microcontroller, whole reference runs and holds.

    controller --> BridgeDriver --bytes, at random paces--> firmware --pins--> twin mill

Time is the chip's; the host is held up now and then, so that words and questions meet at random
moments. A job that is not over after ``LIMIT_S`` of the chip's time hangs. Truth is the mill on the
chip's pins: what the driver counted must be what its carriages did. Measured is how long the job
took, in the chip's time.
"""

from collections.abc import Callable, Sequence
from typing import Final

from bench.campaign.frame import Attempt, Kind, Outcome
from fraese.control.controller import Controller
from fraese.control.state import Status
from fraese.errors import FraeseError
from fraese.machine import Machine
from tests.bridge.device import reason_to_skip
from tests.bridge.firmwaremill import FirmwareBench
from tests.helpers import axes, configured

#: A job of a few millimetres takes three seconds at most.
LIMIT_S: Final = 20.0
#: Reference runs and holds, each.
_MANY: Final = 1000
_AWAY_ONE_IN: Final = 6
_NEAR_STEPS: Final = (-20, 500)
#: Where a reference run ends, from the switch; the mill's switches are on the pins a little later.
_PULL_OFF_STEPS: Final = 200
_SPREAD_STEPS: Final = 6


class Hung(Exception):
    """The job does not come to an end."""


class Setting:
    """A machine behind a bridge whose host is away now and then.

    Args:
        attempt: whose chance it is.

    Attributes:
        bench: firmware and mill.
        controller: of the whole machine.
        at_slice: called after every slice of the run loop.
    """

    def __init__(self, attempt: Attempt) -> None:
        self._chance = attempt.random
        self.bench = FirmwareBench("smc")
        config = configured(
            axes=axes(travel_mm=100, home_end="min"),
            homing={"approach_mm_min": 1500, "pull_off_mm": 1, "slow_mm_min": 300},
        )
        machine = Machine.from_config(config)
        slice_s = attempt.random.uniform(0.006, 0.03)
        self.controller = Controller(
            machine, self.bench.driver, self.bench.clock, config, slice_s=slice_s
        )
        self.controller.set_show_pos(self._slice)
        self.at_slice: Callable[[], None] = lambda: None
        self._until_ns = 0

    def now_s(self) -> float:
        """The chip's time."""
        return self.bench.clock.now_ns() * 1e-9

    def run(self) -> Status:
        """What was commanded; raises ``Hung`` if it does not end."""
        self._until_ns = self.bench.clock.now_ns() + round(LIMIT_S * 1e9)
        return self.controller.run()

    def _slice(self) -> None:
        if not self._chance.randrange(_AWAY_ONE_IN):
            self.bench.wait(self._chance.uniform(0, 0.04))
        if self.bench.clock.now_ns() > self._until_ns:
            report = self.controller._loop._queue.report
            raise Hung(f"not over after {LIMIT_S:g} s: {report}")
        self.at_slice()

    def unaccounted(self, before: Sequence[float], counted: Sequence[int]) -> int:
        """Steps of the carriages that were not counted."""
        report = self.bench.driver.poll(0)
        moved = [b - a for a, b in zip(before, self.bench.carriages(), strict=True)]
        made = [b - a for a, b in zip(counted, report.position_steps, strict=True)]
        return round(sum(abs(m - n) for m, n in zip(moved, made, strict=True)))


def reference_run(attempt: Attempt) -> Outcome:
    """One axis is referenced, from some place near its switch, or on it."""
    setting = Setting(attempt)
    axis = attempt.random.choice("xy")
    setting.bench.place(axis, attempt.random.randint(*_NEAR_STEPS))
    setting.controller.idle()
    before, counted = setting.bench.carriages(), setting.bench.driver.poll(0).position_steps
    since_s = setting.now_s()
    setting.controller.home([axis])
    status = setting.run()
    took_s = setting.now_s() - since_s
    assert status is Status.OK, setting.controller.state().message
    unaccounted = setting.unaccounted(before, counted)
    from_switch = setting.bench.twin.simulated.look().carriages_steps["xyz".index(axis)]
    off_steps = abs(from_switch - _PULL_OFF_STEPS)
    note = f"{unaccounted} steps not counted, zero is {off_steps:g} steps off"
    return Outcome(max(unaccounted, round(max(0, off_steps - _SPREAD_STEPS))), took_s, note)


def hold(attempt: Attempt) -> Outcome:
    """A move is held at some moment, goes on, and is held again."""
    setting, chance = Setting(attempt), attempt.random
    before, counted = setting.bench.carriages(), setting.bench.driver.poll(0).position_steps
    since_s = setting.now_s()
    distance_mm = chance.uniform(2, 6)
    setting.controller.jog(chance.choice("xyz"), distance_mm)
    moments_s = sorted(since_s + chance.uniform(0, 0.5) for _ in range(2))
    go_on_s: list[float] = []

    def act() -> None:
        runner = setting.controller._loop.runner
        if moments_s and setting.now_s() >= moments_s[0] and not go_on_s:
            moments_s.pop(0)
            setting.controller.hold()
            go_on_s.append(setting.now_s() + chance.uniform(0, 0.3))
        elif go_on_s and setting.now_s() >= go_on_s[0] + (not runner.held):
            # Held, or in vain: the move was over.
            go_on_s.clear()
            setting.controller.resume()

    setting.at_slice = act
    status = setting.run()
    assert status is Status.OK, setting.controller.state().message
    took_s = setting.now_s() - since_s
    unaccounted = setting.unaccounted(before, counted)
    return Outcome(unaccounted, took_s, f"{unaccounted} steps not counted")


def plug(attempt: Attempt) -> Outcome:
    """The plug is pulled in a move, and put back: the bounds that are told hold, and it goes on."""
    setting, chance = Setting(attempt), attempt.random
    bench = setting.bench
    axis = chance.randrange(3)
    setting.controller.jog("xyz"[axis], chance.uniform(4, 12))
    at_s = setting.now_s() + chance.uniform(0.02, 0.4)

    def act() -> None:
        if setting.now_s() >= at_s and bench.chip.plugged:
            bench.unplug()

    setting.at_slice = act
    before = bench.carriages()[axis]
    status = setting.run()
    if status is Status.OK:
        return Outcome(missed=True)
    said = setting.controller.state().message
    # With the plug goes the board's current: what was made until then lies within the bounds.
    bench.wait(3.0)
    low, high = _bounds(said, axis)
    made = bench.carriages()[axis] - before
    beyond = max(low - made, made - high, 0)
    setting.at_slice = lambda: None
    bench.plug_in()
    since_s = setting.now_s()
    setting.controller.acknowledge()
    while True:
        assert setting.now_s() < since_s + 5, "it is not found again"
        bench.wait(0.1)
        try:
            setting.controller.idle()
            break
        except FraeseError:
            continue
    return Outcome(round(beyond), high - low, f"{said}: true {made:g}")


def _bounds(said: str, axis: int) -> tuple[int, int]:
    """Of a motor, from the sentence."""
    words = said.partition(f"motor {axis + 1} ")[2].replace(",", "").replace(".", "").split()
    low = int(words[0])
    return low, int(words[2]) if words[1:2] == ["to"] else low


KINDS: Final = (
    Kind("reference run on the bridge", "s it took", reference_run, _MANY, missing=reason_to_skip),
    Kind("hold on the bridge", "s it took", hold, _MANY, missing=reason_to_skip),
    Kind("USB plug of the bridge, out and in", "steps between the bounds told", plug,
         missing=reason_to_skip),
)  # fmt: skip
