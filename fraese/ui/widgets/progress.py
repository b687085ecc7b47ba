"""Progress of a program: what is done, how long it still takes, when it ends by the clock."""

from datetime import datetime, timedelta

from textual.app import ComposeResult
from textual.containers import Vertical

from fraese.control.state import JobProgress, MachineState, Status
from fraese.phrases import shown, spoken
from fraese.ui.widgets import modal
from fraese.ui.widgets.fact import Fact
from fraese.ui.widgets.status import clock_words

#: A bar is no shorter, in cells.
_SHORTEST = 8


def bar(share: float, room: int) -> str:
    """So much of a bar of so many cells is full, to an eighth of a cell."""
    eighths = round(min(1.0, max(0.0, share)) * room * 8)
    full, rest = divmod(eighths, 8)
    part = " ▏▎▍▌▋▊▉"[rest] if rest else ""
    return ("█" * full + part).ljust(room, "░")


def times(job: JobProgress, *, waits: bool, now: datetime) -> str:
    """Done, left, and the end by the clock.

    Args:
        job: the program in hand.
        waits: nothing moves until a person does something.
        now: by the clock.
    """
    said = [spoken("{clock_words} done", clock_words=clock_words(job.elapsed_s))]
    if job.left_s is not None:
        said.append(spoken("{clock_words} left", clock_words=clock_words(job.left_s)))
        if waits:
            said.append(spoken("waits"))
        else:
            end = now + timedelta(seconds=job.left_s)
            said.append(spoken("ends {clock}", clock=f"{end:%H:%M}"))
    return "   ".join(said)


def switches(state: MachineState) -> str:
    """Both overrides, and the switches that are on."""
    said = [
        spoken("feed {override:.0%}", override=state.override),
        spoken("rapids {rapid_override:.0%}", rapid_override=state.rapid_override),
    ]
    return "   ".join([*said, *modal.switches(state)])


class ProgressPanel(Vertical):
    """Two lines: the bar with its times; overrides and switches."""

    def __init__(self) -> None:
        super().__init__(id="progress")
        self._bar = Fact("", id="progress-bar")
        self._times = Fact("", id="progress-times")

    def compose(self) -> ComposeResult:
        """One above the other."""
        yield self._bar
        yield self._times

    @property
    def texts(self) -> tuple[str, str]:
        """What it says."""
        return self._bar.text, self._times.text

    def show_idle(self, name: str, more: str, state: MachineState) -> None:
        """No program runs: which one is loaded, and what is known of it."""
        self._bar.show(f"{shown(name)}   {more}" if more else name)
        self._times.show(switches(state), "-weak")

    def show_check(self, name: str, lines: int, of_lines: int) -> None:
        """It is being looked through.

        Args:
            name: of the program.
            lines: read so far.
            of_lines: lines of the file; 0: not known yet.
        """
        share = lines / of_lines if of_lines else 0.0
        words = (
            spoken("line {lines:,} of {of_lines:,}", lines=lines, of_lines=of_lines)
            if of_lines
            else spoken("reading")
        )
        self._bar.show(
            spoken("checking {filled}  {share:4.0%}", filled=self._filled(share, 28), share=share)
        )
        self._times.show(f"{shown(name)}   {words}", "-weak")

    def show_job(self, state: MachineState, job: JobProgress) -> None:
        """A program runs."""
        place = (
            spoken("line {line}/{lines}", line=job.line, lines=job.lines)
            if job.lines
            else spoken("line {line}", line=job.line)
        )
        if job.share is None:
            self._bar.show(f"{shown(job.name)}   {place}")
        else:
            self._bar.show(f"{self._filled(job.share, 26)}  {job.share:4.0%}   {place}")
        waits = state.held or bool(state.question)
        said = times(job, waits=waits, now=datetime.now())
        self._times.show(f"{said}   {switches(state)}", "")

    def _filled(self, share: float, taken: int) -> str:
        return bar(share, max(_SHORTEST, self.size.width - taken - 2))


def runs_program(state: MachineState) -> bool:
    """A program is in hand, not a jog."""
    return state.status is Status.RUN and state.job is not None and state.job.lines > 0
