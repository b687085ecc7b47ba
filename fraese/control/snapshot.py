"""One look at the machine: what the controller's parts know, as one frozen fact.

Rule 1: from any thread. Every part replaces whole what is read here; a look is of one report, but
        what the operator has just ordered may show in it before the motors know.
"""

from dataclasses import replace

from fraese.anythread import any_thread
from fraese.control.endswitches import EndSwitches
from fraese.control.motionqueue import MotionQueue
from fraese.control.onlooker import Seen
from fraese.control.position import Position
from fraese.control.runloop import RunLoop
from fraese.control.state import MachineState, Status, WorkFacts
from fraese.motor.pins import STATUS_PINS, levels


@any_thread
def snapshot(
    loop: RunLoop,
    queue: MotionQueue,
    where: Position,
    switches: EndSwitches,
    *,
    log_on: bool,
    step_word: str,
    seen: Seen,
) -> MachineState:
    """Everything that can be shown, as it is now.

    Args:
        loop: status, job, message.
        queue: the driver's last report; overrides and switches.
        where: positions and references.
        switches: what the inputs mean.
        log_on: the log is being written.
        step_word: what the card calls one step.
        seen: what an onlooker sees.
    """
    report, axes, frame = queue.report, where.machine.axes, where.frame
    return MachineState(
        status=loop.status,
        message=loop.message,
        alarm=loop.alarm.kind if loop.alarm else None,
        axes=tuple(axis.name for axis in axes),
        position_steps=(position_steps := where.position_steps),
        position_mm=(position_mm := where.machine.to_mm(position_steps)),
        work_mm=frame.to_work(position_mm),
        offset_mm=frame.origin,
        work=WorkFacts.of(frame, where.offsets.tool),
        referenced=where.referenced,
        low_mm=tuple(axis.low_mm for axis in axes),
        high_mm=tuple(axis.high_mm for axis in axes),
        speed_mm_min=queue.mm_s() * 60,
        speed_unit=queue.speed_unit,
        running=report.running,
        held=loop.runner.held and loop.status is Status.RUN,
        energised=report.energised,
        switch_closed=report.switch_closed,
        ends=switches.names(),
        switch_ignored=switches.ignored,
        inputs=levels(report.inputs, STATUS_PINS),
        job=(job := loop.progress()) and replace(job, doing=loop.runner.doing),
        log_on=log_on,
        late_ticks=report.late_ticks,
        dry_queues=report.dry_queues,
        question=loop.runner.question,
        override=queue.handling.feed,
        rapid_override=queue.handling.rapid,
        obeys_override=not report.running or queue.obeys_feed,
        single_block=queue.handling.single_block,
        optional_stop=queue.handling.optional_stop,
        block_delete=queue.handling.block_delete,
        units=tuple(axis.unit for axis in axes),
        step_word=step_word,
        carriages_mm=seen.carriages_mm,
        lost_steps=seen.lost_steps,
        lost_why=seen.lost_why,
        to_go_mm=where.to_go_mm if loop.status is Status.RUN else (),
        phases=report.phases,
        cut_short=loop.unfinished.place,
    )
