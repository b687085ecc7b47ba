"""What is in force, in one line: offset, tool, spindle, feed and overrides, switches of a run.

G54  G92  MAP  SENDER mill  T2  D3  G43 12.5  S12000 on by hand  F300 × 80% = 240  rapids 50%
                                              S500 laser 50% M4
"""

from collections.abc import Iterator

from rich.cells import cell_len

from fraese.control.state import MachineState, Status
from fraese.phrases import spoken
from fraese.ui.widgets.fact import Fact


def in_force(state: MachineState) -> list[str]:
    """The words, the most important first."""
    return [
        *_where(state),
        *_sender(state),
        *_tool(state),
        *_spindle(state),
        *_feed(state),
        *switches(state),
    ]


def switches(state: MachineState) -> list[str]:
    """Switches of a run that are on."""
    said = (
        (spoken("single block"), state.single_block),
        (spoken("M1 stops"), state.optional_stop),
        (spoken("/ left out"), state.block_delete),
    )
    return [name for name, on in said if on]


def _sender(state: MachineState) -> Iterator[str]:
    """Who else drives the machine, by the last part of where he is."""
    sender = state.sender
    if sender.is_out:
        yield spoken("SENDER OUT")
    elif sender.name:
        yield spoken("SENDER {name}", name=sender.name.rpartition("/")[2])


def _where(state: MachineState) -> Iterator[str]:
    work = state.work
    yield work.system
    if work.g92:
        yield "G92"
    if work.rotation_deg:
        yield f"R{work.rotation_deg:g}°"
    if state.job is not None and state.job.height_map and state.status is Status.RUN:
        yield spoken("MAP")


def _tool(state: MachineState) -> Iterator[str]:
    work = state.work
    if work.tool:
        yield f"T{work.tool}"
        if work.tool_diameter_mm:
            yield f"D{work.tool_diameter_mm:g}"
    if any(work.tool_offset_mm):
        yield f"G43 {work.tool_length_mm:g}"


def _spindle(state: MachineState) -> Iterator[str]:
    cutting = state.cutting
    if not cutting.direction and not cutting.rev_min:
        return
    speed = f"S{cutting.rev_min:g}"
    if not cutting.direction:
        yield spoken("{speed} off", speed=speed)
        return
    if cutting.is_laser:
        yield _burning(speed, state)
        return
    clockwise = cutting.direction > 0
    turning = spoken("{speed} on", speed=speed) if clockwise else _to_the_left(speed)
    yield spoken("{turning} by hand", turning=turning) if cutting.by_hand else turning


def _burning(speed: str, state: MachineState) -> str:
    """A beam; M4 where its power goes with the speed that is played."""
    cutting = state.cutting
    if cutting.power_percent is None:
        return spoken("{speed} laser on", speed=speed)
    share = f"{cutting.power_percent:.3g}%" + (" M4" if cutting.direction < 0 else "")
    return spoken("{speed} laser {share}", speed=speed, share=share)


def _to_the_left(speed: str) -> str:
    return spoken("{speed} on, to the left", speed=speed)


def _feed(state: MachineState) -> Iterator[str]:
    feed, factor = state.cutting.feed_mm_min, state.override
    if feed and factor != 1:
        yield f"F{feed:.4g} × {factor:.0%} = {feed * factor:.4g}"
    elif feed:
        yield f"F{feed:.4g}"
    elif factor != 1:
        yield spoken("feed {override:.0%}", override=factor)
    if factor != 1 and not state.obeys_override:
        yield spoken("not here")
    if state.rapid_override != 1:
        yield spoken("rapids {rapid_override:.0%}", rapid_override=state.rapid_override)


class ModalStrip(Fact):
    """What is in force; where there is little room, closer together."""

    def show_state(self, state: MachineState) -> None:
        """Draw what changed."""
        parts = in_force(state)
        text = "  ".join(parts)
        fits = cell_len(text) <= self.size.width
        self.show(text if fits else " ".join(parts))
