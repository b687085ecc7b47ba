"""The state of the machine over the full width: a word, large, on a colour that says the same."""

from collections.abc import Sequence
from dataclasses import dataclass

from rich.cells import cell_len
from textual.app import ComposeResult
from textual.containers import Horizontal, Vertical
from textual.content import Content
from textual.geometry import Size

from fraese.control.state import MachineState, Status, three_decimals
from fraese.phrases import shown, spoken
from fraese.ui.shape import Shape
from fraese.ui.widgets.fact import Fact, Flowing
from fraese.ui.widgets.glyphs import THIN
from fraese.ui.widgets.modal import ModalStrip
from fraese.ui.widgets.status import lost_words, switch_words


@dataclass(frozen=True, slots=True)
class Seen:
    """What the bar says.

    Attributes:
        word: the state.
        tone: a CSS class.
        beside: what else is worth to be told from afar, in normal letters; empty: nothing.
    """

    word: str
    tone: str
    beside: str = ""


def seen(state: MachineState, stopping: bool) -> Seen:
    """The one thing that matters most now, and what is true beside it.

    Args:
        state: how the machine stands.
        stopping: the operator has pressed stop and it still moves.
    """
    closed = state.switch_closed
    ends = spoken(" or ").join(state.ends)
    lacking = _not_referenced(state)
    if state.status is Status.ERROR:
        number = spoken("alarm {number}", number=state.alarm.number) if state.alarm else ""
        return Seen(
            spoken("ALARM {ends}", ends=ends).rstrip() if state.alarm else spoken("ERROR"),
            "-alarm",
            number,
        )
    if state.status is Status.RUN:
        beside = spoken("SWITCH CLOSED {ends}", ends=ends).rstrip() if closed else lacking
        if stopping:
            return Seen(spoken("STOPPING"), "-warn", beside)
        if state.question:
            what = shown(state.waits_for)
            return Seen(spoken("WAIT {what}", what=what).rstrip(), "-warn", beside)
        return (
            Seen(spoken("HOLD"), "-warn", beside)
            if state.held
            else Seen(spoken("MOVING"), "-run", beside)
        )
    if closed:
        return Seen(spoken("SWITCH CLOSED"), "-alarm", ends + ("?" if len(state.ends) > 1 else ""))
    if lacking:
        return Seen(
            spoken("NOT REFERENCED"), "-warn", lacking.removeprefix(spoken("NOT REFERENCED "))
        )
    return Seen(spoken("READY"), "-good")


def _not_referenced(state: MachineState) -> str:
    names = [
        name.upper() for name, known in zip(state.axes, state.referenced, strict=True) if not known
    ]
    return spoken("NOT REFERENCED {names}: no limits", names=" ".join(names)) if names else ""


class BigWord(Fact):
    """A word as large as there is room for."""

    flows = True

    def get_content_width(self, container: Size, viewport: Size) -> int:
        """What it needs."""
        return cell_len(self._lines(container)[0])

    def render(self) -> Content:
        """In large letters, or as it is."""
        return Content("\n".join(self._lines(self.size)))

    def _lines(self, room: Size) -> Sequence[str]:
        for double in (True, False):
            lines = THIN.lines(self.text.upper(), double=double)
            if room.height >= THIN.rows(double=double) and len(lines[0]) <= room.width:
                return lines
        return [self.text]


class StateBar(Horizontal):
    """The word, and beside it what else is true."""

    def __init__(self) -> None:
        super().__init__(id="state")
        self._word = BigWord(spoken("READY"), id="word")
        self._beside = Fact("", id="beside")

    def compose(self) -> ComposeResult:
        """Side by side."""
        yield self._word
        yield self._beside

    def show(self, state: MachineState, stopping: bool) -> None:
        """Draw what changed."""
        said = seen(state, stopping)
        if said.word != self._word.text:
            self.set_classes({said.tone})
        self._word.show(said.word)
        self._beside.show(said.beside)


class FactsLine(Horizontal):
    """One row: position where it is not shown large, switch, speed or motors, log.

    Where a row of its own is too much, what is in force stands here.

    Args:
        shape: of the machine.
    """

    def __init__(self, shape: Shape) -> None:
        super().__init__(id="facts")
        self._shape = shape
        self._at = Flowing("", id="at")
        self._work = ModalStrip("", id="work")
        self._switch = Fact(spoken("switch open"), id="switch")
        self._ignored = Fact("", id="ignored")
        self._feed = Fact("", id="feed")
        self._log = Fact("", id="log")

    def compose(self) -> ComposeResult:
        """From left to right."""
        yield self._at
        yield self._work
        yield self._switch
        yield self._ignored
        yield self._feed
        yield self._log

    def show(self, state: MachineState) -> None:
        """Draw what changed."""
        if self._at.display:
            self._at.show(
                " ".join(
                    f"{axis.letter}{three_decimals(at).rjust(9)}"
                    for axis, at in zip(self._shape.axes, state.work_mm, strict=True)
                )
            )
        if self._work.display:
            self._work.show_state(state)
        self._switch.show(switch_words(state), "-alarm" if state.switch_closed else "-weak")
        self._ignored.show(
            spoken("SWITCHES IGNORED") if state.switch_ignored else "",
            "-alarm" if state.switch_ignored else "",
        )
        moving = state.running and state.speed_mm_min > 0
        speed = spoken(
            "{speed_mm_min:.0f} {speed_unit}/min",
            speed_mm_min=state.speed_mm_min,
            speed_unit=state.speed_unit,
        )
        still = spoken("standing") if state.energised else spoken("motors off")
        self._feed.show(speed if moving else still, "" if state.energised or moving else "-weak")
        self._log.show(
            spoken("log on") if state.log_on else spoken("log off"), "" if state.log_on else "-weak"
        )


class Top(Vertical):
    """What every view begins with.

    Args:
        shape: of the machine.
    """

    def __init__(self, shape: Shape) -> None:
        super().__init__(id="top")
        self._bar = StateBar()
        self._facts = FactsLine(shape)
        self._modal = ModalStrip("", id="modal")
        self._lost = Fact("", id="lost")

    def compose(self) -> ComposeResult:
        """State, facts, what is in force, and a line where steps were lost."""
        yield self._bar
        yield self._facts
        yield self._modal
        yield self._lost

    @property
    def tells_of_lost_steps(self) -> bool:
        """There is a line more."""
        return bool(self._lost.text)

    def show(self, state: MachineState, stopping: bool) -> None:
        """Draw what changed."""
        self._bar.show(state, stopping)
        self._facts.show(state)
        if self._modal.display:
            self._modal.show_state(state)
        lost = lost_words(state)
        self._lost.show(lost, "-alarm" if lost else "")
