"""The polled motor core (SMCMOT): plays blocks on any card, any port, by any clock.

    push -> BlockQueue -> Run -> Ticks -> Wires -> card, port
    brake, stop -> Requests -> Governor --'  |
    poll <- Report <- Track <----------------+-- readings -> Reactions -> Requests

Rule 1: ``brake`` and ``stop`` set a flag, from any thread. All else is called from one thread, and
        nothing happens but in ``poll`` and at standstill.
Rule 2: a report is made of what each part knows at that moment; nothing is kept for it.
Rule 3: on the way out the motors are off and the port is given back, whatever goes wrong.
"""

from fraese.anythread import any_thread
from fraese.blocks import Q8, Block
from fraese.motor.horizon import DryPoint
from fraese.motor.run import Run
from fraese.motor.seams import Card, Clock, Ended, IdleLevel, Port, Report, SwitchMode
from fraese.motor.switches import SwitchInput
from fraese.phrases import phrase


class MotorCore:
    """The peer behind the StepDriver seam that drives a port itself.

    Args:
        port: registers to write; closed with the core.
        card: what they mean.
        clock: when.
        switch: the shared end-switch input.
        settle_s: wait after energising, before the first step.
        capacity: blocks that the queue takes.
        safe_outputs: free outputs that are off whenever the motors stand (a laser).
    """

    def __init__(
        self,
        port: Port,
        card: Card,
        clock: Clock,
        switch: SwitchInput = SwitchInput(),  # noqa: B008 (immutable)
        settle_s: float = 0.02,
        capacity: int = 256,
        safe_outputs: int = 0,
    ) -> None:
        self._card = card
        self._run = Run(port, card, clock, switch, settle_s, capacity, safe_outputs)
        self._requests = self._run.requests
        self._closed = False
        self._run.wires.idle(IdleLevel.OFF)

    @property
    def run(self) -> Run:
        """The rooms behind the door, for one who drives the core in a process of its own."""
        return self._run

    @property
    def card(self) -> Card:
        """What the registers mean."""
        return self._card

    def push(self, block: Block) -> bool:
        """Take a final block; False: the queue is full and nothing was taken.

        Raises:
            ValueError: if the block cannot be played as it says; nothing was taken.
        """
        if not self._run.queue.push(block):
            return False
        self._run.governor.refilled()
        return True

    def accept(self, block: Block, dry_point: DryPoint | None) -> None:
        """Take a block whose dry point somebody else has computed, with time to spare.

        Args:
            block: a sound one; there must be room for it.
            dry_point: where braking must begin if nothing comes after it, its block counted from
                this one on: 0 or less. None: nowhere.
        """
        queue = self._run.queue
        queue.accept(block, dry_point and dry_point.moved(queue.next_serial))
        self._run.governor.refilled()

    @any_thread
    def brake(self) -> None:
        """Close the throttle; the queue stays."""
        self._requests.brake()

    @any_thread
    def set_override(self, factor: float) -> None:
        """Play what was planned with a higher feed override no faster."""
        self._requests.override(round(factor * Q8))

    @any_thread
    def stop(self) -> None:
        """Finish the tick in hand, drop the rest."""
        self._requests.stop()

    def resume(self) -> None:
        """Open the throttle again; not while braking for a watch that ends the run."""
        self._run.governor.resume()

    def flush(self) -> None:
        """Drop the queue at standstill, and open the throttle for what comes next.

        Raises:
            StateError: while steps are being made.
        """
        self._run.require_standstill(phrase("the queue can only be dropped"))
        self._run.finish(Ended.FLUSH)

    def idle(self, level: IdleLevel) -> None:
        """Set the standstill current.

        Raises:
            StateError: while steps are being made.
        """
        self._run.require_standstill(phrase("the motors can only be switched off"))
        self._run.wires.idle(level)

    def set_outputs(self, mask: int, value: int) -> None:
        """Change free outputs now; those that must be safe at standstill, at the next start."""
        self._run.wires.set_outputs(mask, value, standing=self._run.standing)

    def set_switch_mode(self, mode: SwitchMode) -> None:
        """Choose what an end switch does to blocks that do not watch it."""
        self._run.reactions.mode = mode

    def close(self) -> None:
        """Motors and outputs off, port given back (MotEnd). Safe to call twice."""
        if self._closed:
            return
        self._closed = True
        try:
            self._run.finish(Ended.STOP)
        finally:
            self._run.wires.close()

    def poll(self, budget_s: float) -> Report:
        """Play for at most that long, in the core's clock, and say where things stand."""
        self._run.poll(budget_s)
        return self._report()

    def _report(self) -> Report:
        run, queue, track, inputs = self._run, self._run.queue, self._run.track, self._run.inputs
        cursor = track.cursor
        return Report(
            position_steps=track.position_steps(),
            travelled_steps=track.travelled_steps(),
            playing=queue.serial,
            finished=track.finished,
            tag=track.tag,
            tick=cursor.done if cursor else 0,
            free=queue.free,
            queued=len(queue) + (cursor is not None),
            due_ns=run.ticks.next_due_ns(cursor) if cursor and not run.standing else 0,
            rate_hz=track.rate_hz(),
            running=run.may_play,
            held=run.governor.held,
            energised=run.wires.energised,
            inputs=inputs.status,
            switch_closed=inputs.switch_closed,
            candidates=inputs.candidates,
            latched_steps=inputs.latched_steps,
            ended=run.ended,
            torn=track.torn,
            late_ticks=run.ticks.late_ticks,
            dry_queues=run.governor.dry_queues,
            phases=self._card.phases(),
        )
