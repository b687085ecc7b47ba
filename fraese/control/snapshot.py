"""One look at the machine: what the controller's parts know, as one frozen fact.

Rule 1: from any thread. Every part replaces whole what is read here; a look is of one report, but
        what the operator has just ordered may show in it before the motors know.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from fraese.anythread import any_thread
from fraese.config.work import ToolConfig
from fraese.control.aims import Aims
from fraese.control.cutting import CuttingHistory
from fraese.control.endswitches import EndSwitches
from fraese.control.jobs import move_of
from fraese.control.motionqueue import MotionQueue
from fraese.control.onlooker import Seen
from fraese.control.position import Position
from fraese.control.runloop import RunLoop
from fraese.control.state import MachineState, Status, WorkFacts
from fraese.machine import Axis
from fraese.motor.pins import STATUS_PINS, levels
from fraese.tooldata import ToolData, changed_tool


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
    cutting: CuttingHistory,
    aims: Aims,
    tools: Mapping[str, ToolConfig],
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
        cutting: feed and spindle.
        aims: where the move in hand ends.
        tools: the tool table.
    """
    report, job = queue.report, loop.progress()
    position_steps, frame = where.position_steps, where.frame
    tool, runner = where.offsets.tool, loop.runner
    return MachineState(
        **_of_axes(where.machine.axes),
        **_wanted(queue),
        **_watched(seen),
        status=loop.status,
        message=loop.message,
        alarm=loop.alarm.kind if loop.alarm else None,
        position_steps=position_steps,
        position_mm=(position_mm := where.machine.to_mm(position_steps)),
        work_mm=frame.to_work(position_mm),
        offset_mm=frame.origin,
        work=WorkFacts.of(frame, tool, _tool_data(where, tools, tool)),
        cutting=cutting.at(move_of(queue.tag)),
        referenced=where.referenced,
        speed_mm_min=queue.mm_s() * 60,
        speed_unit=queue.speed_unit,
        running=report.running,
        held=runner.held and loop.status is Status.RUN,
        energised=report.energised,
        switch_closed=report.switch_closed,
        ends=switches.names(),
        switch_ignored=switches.ignored,
        inputs=levels(report.inputs, STATUS_PINS),
        job=job and replace(job, doing=runner.doing),
        log_on=log_on,
        late_ticks=report.late_ticks,
        dry_queues=report.dry_queues,
        question=runner.question,
        waits_for=runner.waits_for,
        step_word=step_word,
        to_go_mm=aims.to_go_mm if loop.status is Status.RUN else (),
        phases=report.phases,
        cut_short=loop.unfinished.place,
    )


def _tool_data(
    where: Position, tools: Mapping[str, ToolConfig], number: int
) -> ToolData | ToolConfig | None:
    """Of the tool in the spindle: a program may have changed it."""
    configured = next((tool for key, tool in tools.items() if int(key) == number), None)
    data = ToolData(configured.length_mm, configured.diameter_mm) if configured else ToolData()
    return changed_tool(number, where.offsets.parameters, data) or configured


def _of_axes(axes: Sequence[Axis]) -> dict[str, Any]:
    """What never changes."""
    return {
        "axes": tuple(axis.name for axis in axes),
        "low_mm": tuple(axis.low_mm for axis in axes),
        "high_mm": tuple(axis.high_mm for axis in axes),
        "units": tuple(axis.unit for axis in axes),
    }


def _watched(seen: Seen) -> dict[str, Any]:
    """What no driver can know."""
    return {
        "carriages_mm": seen.carriages_mm,
        "lost_steps": seen.lost_steps,
        "lost_why": seen.lost_why,
    }


def _wanted(queue: MotionQueue) -> dict[str, Any]:
    """What the operator chose, and whether what moves obeys."""
    handling = queue.handling
    return {
        "obeys_override": not queue.report.running or queue.obeys_feed,
        "override": handling.feed,
        "rapid_override": handling.rapid,
        "single_block": handling.single_block,
        "optional_stop": handling.optional_stop,
        "block_delete": handling.block_delete,
    }
