"""State, switch, motors, log, width; the job in hand; the last message."""

from collections.abc import Sequence

from textual.app import ComposeResult
from textual.containers import Horizontal, Vertical

from fraese.control.state import JobProgress, MachineState, Status
from fraese.ui.keys import Row, said
from fraese.ui.widgets.fact import Fact
from fraese.ui.widgets.links import Link
from fraese.ui.widths import Width

_TONES = {
    "OK": "-good", "RUN": "-run", "HOLD": "-warn", "WAIT": "-warn", "CANCEL": "-warn",
    "ERROR": "-alarm",
}  # fmt: skip


def status_word(state: MachineState, stopping: bool) -> str:
    """OK, RUN, CANCEL, ERROR; HOLD and WAIT where a running job stands."""
    if state.status is not Status.RUN:
        return str(state.status.value)
    if stopping:
        return "CANCEL"
    if state.question:
        return "WAIT"
    return "HOLD" if state.held else "RUN"


def switch_words(state: MachineState) -> str:
    """The end switch with its name; several candidates are a question."""
    if not state.switch_closed:
        return "switch open"
    ends = " or ".join(state.ends)
    if not ends:
        return "switch ?"
    return "switch " + ends + ("?" if len(state.ends) > 1 else "")


def lost_words(state: MachineState) -> str:
    """What motors of a simulated mill did not follow, how far, and why; empty if nothing."""
    lost = [
        f"{name.upper()} {abs(steps):g} {state.step_word}s ({why})"
        for name, steps, why in zip(state.axes, state.lost_steps, state.lost_why, strict=False)
        if why
    ]
    return "LOST STEPS  " + ", ".join(lost) if lost else ""


def clock_words(seconds: float) -> str:
    """Minutes and seconds, with hours where there are any."""
    minutes, rest = divmod(int(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}" if hours else f"{minutes}:{rest:02d}"


class StatusPanel(Vertical):
    """Two lines: who and what is loaded; how the machine stands. A third where steps were lost.

    Args:
        machine_name: which machine is driven, such as "simulated mill"; may be empty.
    """

    def __init__(self, machine_name: str) -> None:
        super().__init__(id="status")
        self._title = Fact("fraese" + (f" · {machine_name}" if machine_name else ""), id="title")
        self._program = Fact("no program", id="program")
        self._word = Fact("OK", id="word")
        self._switch = Fact("switch open", id="switch")
        self._ignored = Fact("", id="ignored")
        self._feed = Fact("", id="feed")
        self._motors = Fact("", id="motors")
        self._log = Fact("", id="log")
        self._lost = Fact("", id="lost")

    def compose(self) -> ComposeResult:
        """The lines."""
        with Horizontal():
            yield self._title
            yield self._program
        with Horizontal():
            yield self._word
            yield self._switch
            yield self._ignored
            yield self._feed
            yield self._motors
            yield self._log
        yield self._lost

    @property
    def tells_of_lost_steps(self) -> bool:
        """There is a third line."""
        return bool(self._lost.text)

    def show_program(self, name: str) -> None:
        """This program is loaded."""
        self._program.show(name)

    def show(self, state: MachineState, stopping: bool) -> None:
        """Draw what changed.

        Args:
            state: how the machine stands.
            stopping: the operator has pressed stop and it still moves.
        """
        word = status_word(state, stopping)
        self._word.show(word, _TONES[word])
        self._switch.show(switch_words(state), "-alarm" if state.switch_closed else "-weak")
        self._ignored.show(
            "SWITCHES IGNORED" if state.switch_ignored else "",
            "-alarm" if state.switch_ignored else "",
        )
        moving = state.running and state.speed_mm_min > 0
        speed = f"{state.speed_mm_min:.0f} {state.speed_unit}/min" if moving else "standing"
        override = "" if state.override == 1 else f"{state.override:.0%}  "
        self._feed.show(override + speed)
        self._motors.show(
            "motors on" if state.energised else "motors off", "" if state.energised else "-weak"
        )
        self._log.show("log on" if state.log_on else "log off", "" if state.log_on else "-weak")
        lost = lost_words(state)
        self._lost.show(lost, "-alarm" if lost else "")


class WidthBar(Horizontal):
    """The jog widths to choose from.

    Args:
        choice: the widths,
        keys: and their keys with the actions.
    """

    def __init__(self, choice: Sequence[Width], keys: Sequence[Row]) -> None:
        super().__init__(id="widths")
        self._choice = choice
        self._links = [
            Link(key.action, key.shown, width.label)
            for key, width in zip(keys, choice, strict=True)
        ]
        self._note = Fact("", id="width-note")

    def compose(self) -> ComposeResult:
        """Heading, widths, and the factor of the repeat rule."""
        yield Fact("jog", classes="heading")
        yield from self._links
        yield self._note

    def show(self, chosen: int, factor: int) -> None:
        """Mark the chosen width; the factor at the width of one step."""
        for index, link in enumerate(self._links):
            link.set_class(index == chosen, "-chosen")
        self._note.show(
            f"× {factor}" if factor > 1 and self._choice[chosen].mm is None else "", "-warn"
        )


class MessageLine(Fact):
    """The last thing that a person should know; a long sentence takes a third line."""

    flows = True

    def on_resize(self) -> None:
        """More than two lines: what stands above has less room."""
        self.screen.set_class(self.size.height > 2, "-tight")


class JobLine(Fact):
    """Progress of the job in hand, or what an error waits for."""

    def __init__(self) -> None:
        super().__init__(id="job")

    def show_job(self, state: MachineState) -> None:
        """Draw what changed; empty between jobs."""
        if state.status is Status.ERROR:
            self.show(f"Press {said('acknowledge')} to acknowledge the error.", "-alarm")
            return
        running = state.status is Status.RUN and state.job is not None
        self.show(self._words(state.job) if running and state.job else "")

    def _words(self, job: JobProgress) -> str:
        parts = [job.name]
        if job.lines:
            parts.append(f"line {job.line}/{job.lines}")
        share = _share(job)
        if share is not None:
            parts.append(self._bar(share))
        time = clock_words(job.elapsed_s)
        parts.append(f"{time} / {clock_words(job.expected_s)}" if job.expected_s else time)
        return "  ".join(parts)

    def _bar(self, share: float) -> str:
        room = min(40, max(8, self.size.width - 60))
        full = int(share * room)
        return f"{'█' * full}{'░' * (room - full)} {share:4.0%}"


def _share(job: JobProgress) -> float | None:
    if job.expected_s:
        return min(1.0, job.elapsed_s / job.expected_s)
    return min(1.0, job.line / job.lines) if job.lines else None
