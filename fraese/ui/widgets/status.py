"""Words for facts; the jog widths; the job in hand; the last message."""

from collections.abc import Sequence

from textual.app import ComposeResult
from textual.containers import Horizontal

from fraese.control.state import JobProgress, MachineState, Status
from fraese.phrases import shown, spoken
from fraese.ui.keyrows import Row
from fraese.ui.widgets.fact import Fact
from fraese.ui.widgets.links import Link
from fraese.ui.widths import Width


def switch_words(state: MachineState) -> str:
    """The end switch with its name; several candidates are a question."""
    if not state.switch_closed:
        return spoken("switch open")
    ends = spoken(" or ").join(state.ends)
    if not ends:
        return spoken("switch ?")
    return spoken("switch {ends}", ends=ends + ("?" if len(state.ends) > 1 else ""))


def contact_words(state: MachineState) -> str:
    """The same where it is said already that it is about switches."""
    if not state.switch_closed:
        return spoken("open")
    ends = spoken(" or ").join(state.ends)
    if not ends:
        return spoken("closed, nobody knows which")
    return spoken("{ends} closed", ends=ends + ("?" if len(state.ends) > 1 else ""))


def lost_words(state: MachineState) -> str:
    """What motors of a simulated mill did not follow, how far, and why; empty if nothing."""
    lost = [
        spoken(
            "{axis} {steps:g} {step_word}s ({why})",
            axis=name.upper(),
            steps=abs(steps),
            step_word=state.step_word,
            why=why,
        )
        for name, steps, why in zip(state.axes, state.lost_steps, state.lost_why, strict=False)
        if why
    ]
    return spoken("LOST STEPS  ") + ", ".join(lost) if lost else ""


def clock_words(seconds: float) -> str:
    """Minutes and seconds, with hours where there are any."""
    minutes, rest = divmod(int(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}" if hours else f"{minutes}:{rest:02d}"


def waiting_words(waiting: Sequence[tuple[str, int]]) -> str:
    """Presses of jog keys that wait their turn: X +3, Y −1."""
    return ", ".join(f"{axis.upper()} {'−' if n < 0 else '+'}{abs(n)}" for axis, n in waiting)


class WidthBar(Horizontal):
    """The jog widths to choose from, and how fast jogs go.

    Args:
        choice: the widths,
        keys: and their keys with the actions.
        rate_key: that of the rate, likewise.
    """

    def __init__(self, choice: Sequence[Width], keys: Sequence[Row], rate_key: Row) -> None:
        super().__init__(id="widths")
        self._choice = choice
        self._links = [
            Link(key.action, key.shown, width.label)
            for key, width in zip(keys, choice, strict=True)
        ]
        self._note = Fact("", id="width-note")
        self._rate = Link(rate_key.action, rate_key.shown, "")

    def compose(self) -> ComposeResult:
        """Heading, widths, the factor of the repeat rule, and the rate."""
        yield Fact(spoken("jog"), classes="heading")
        yield from self._links
        yield self._note
        yield self._rate

    def show_rate(self, words: str) -> None:
        """How fast jogs go."""
        self._rate.show_title(words)

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
    """Progress of the job in hand, or what an error waits for.

    Args:
        acknowledge_key: takes note of an error.
    """

    def __init__(self, acknowledge_key: str) -> None:
        super().__init__(id="job")
        self._error = spoken(
            "Press {acknowledge_key} to acknowledge the error.", acknowledge_key=acknowledge_key
        )

    def show_job(
        self,
        state: MachineState,
        waiting: Sequence[tuple[str, int]] = (),
        *,
        programs: bool = True,
    ) -> None:
        """Draw what changed; empty between jobs.

        Args:
            state: how the machine stands.
            waiting: axes whose jog keys were pressed, and how often, signed.
            programs: also of a program; else its progress is seen elsewhere.
        """
        if state.status is Status.ERROR:
            self.show(self._error, "-alarm")
            return
        job = state.job if state.status is Status.RUN else None
        is_elsewhere = not programs and job is not None and job.lines > 0
        words = "" if job is None or is_elsewhere else self._words(job)
        if waiting:
            words += spoken("  waiting: {waiting_words}", waiting_words=waiting_words(waiting))
        self.show(words.strip())

    def _words(self, job: JobProgress) -> str:
        parts = [shown(job.name)]
        if job.lines:
            parts.append(spoken("line {line}/{lines}", line=job.line, lines=job.lines))
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
