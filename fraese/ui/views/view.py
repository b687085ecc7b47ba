"""What all views have in common.

    state, in a word over the full width
    facts: position, switch, speed; what is in force
    position, large, where   |   what the view is for    ``inner``
    there is room for it     |
    the last message
    keys: stop, hold, views

A view is a screen that owns its actions and its widgets. It is one class, one row in the table of
views, one row among the keys that lead to views, and an area of the key table.
"""

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final

from textual.app import ComposeResult
from textual.containers import Horizontal, Vertical
from textual.geometry import Size
from textual.screen import Screen

from fraese.control.benchfacts import Bench
from fraese.control.state import CutShort, MachineState, Status
from fraese.errors import FraeseError
from fraese.phrases import spoken
from fraese.ui.bindings import bind
from fraese.ui.calibrating import Writer
from fraese.ui.dialogs.switches import Hand
from fraese.ui.eventlog import EventLog, Kind
from fraese.ui.handtools import HandTools
from fraese.ui.heldkeys import HeldKeys
from fraese.ui.keyrows import Area, KeyTable
from fraese.ui.keyrows.everywhere import QUIT_AT_ONCE, STOP
from fraese.ui.linehistory import LineHistory
from fraese.ui.machinelink import MachineLink
from fraese.ui.macros import Macro
from fraese.ui.programs import ProgramDesk
from fraese.ui.room import HEIGHTS, WIDTHS
from fraese.ui.settings import SettingsDesk
from fraese.ui.themes import after
from fraese.ui.widgets.keybar import KeyBar
from fraese.ui.widgets.links import Link
from fraese.ui.widgets.position import PositionPanel
from fraese.ui.widgets.statebar import Top
from fraese.ui.widgets.status import MessageLine
from fraese.ui.widths import RepeatRule

BUSY: Final = spoken(
    "The machine runs: stop it ({said}) or wait for the end of the job; nothing was done.",
    said=STOP.said,
)

#: As many axes as this need more rows than a small terminal has for three.
_MANY_AXES: Final = 4
#: From this size on the position is as large beside every view as in Move.
_VAST: Final = Size(190, 45)
#: Actions whose keys are shown behind the stop key however narrow the screen is.
_FIRST_KEYS: Final = ("hold", "help")


@dataclass(frozen=True, slots=True)
class Desk:
    """What a view works with; the same for all.

    Attributes:
        link: to the machine.
        keys: the table of keys.
        repeats: has seen every key that was pressed,
        strokes: and what each stroke of it was.
        programs: what is loaded.
        machine_name: such as "simulated mill"; may be empty.
        hand: presses (True) and lets go of an end switch where the machine is simulated.
        events: what has happened.
        tools: who knows the language.
        history: lines that were typed.
        writer: writes the configuration file; None: there is none to write.
        bench: the machine as it lies open; None: nobody has opened it.
        settings: the configuration file; None: there is none.
        inputs: what was typed last, by the name of the question; it is remembered.
        macros: buttons of one's own.
    """

    link: MachineLink
    keys: KeyTable
    repeats: RepeatRule
    strokes: HeldKeys
    programs: ProgramDesk
    machine_name: str
    hand: Hand | None
    events: EventLog
    tools: HandTools
    history: LineHistory
    writer: Writer | None = None
    bench: Bench | None = None
    settings: SettingsDesk | None = None
    inputs: dict[str, str] = field(default_factory=dict)
    macros: Sequence[Macro] = ()


class Inner(Vertical):
    """Has less room when the position comes to stand beside it."""

    def on_resize(self) -> None:
        """What is drawn to measure is drawn again."""
        if isinstance(self.screen, View):
            self.screen.call_later(self.screen.show_again)


class View(Screen[None]):
    """A screen that shows the machine, with the commands that every view has.

    Args:
        desk: what it works with.
    """

    AREA: Area
    #: Other areas whose keys it has.
    ALSO: tuple[Area, ...] = ()
    #: Name in the table of views.
    NAME: str
    #: Where there is room the position stands beside it, large; else it sees to that itself.
    IS_BESIDE_POSITION = True
    HORIZONTAL_BREAKPOINTS = WIDTHS
    VERTICAL_BREAKPOINTS = HEIGHTS

    def __init__(self, desk: Desk) -> None:
        super().__init__()
        self.desk = desk
        self.state = desk.link.state()
        self._stopping = False
        self._said = ("", "")
        # Which program that was cut short was told of last.
        self._told_of: CutShort | None = None
        self._top = Top(desk.link.shape)
        self._position = PositionPanel(desk.link.shape) if self.IS_BESIDE_POSITION else None
        self.set_class(self._position is not None, "-beside")
        self.set_class(len(desk.link.shape.axes) >= _MANY_AXES, "-many")
        self._message = MessageLine(id="message")
        areas = (self.AREA, *self.ALSO)
        keys = [row for row in desk.keys.of(Area.VIEWS, *areas) if row.footer]
        views = desk.keys.views
        first = [row for row in keys if row.action in _FIRST_KEYS]
        more = [row for row in keys if row not in (*first, *views.values())]
        stop = list(desk.keys.of(Area.EVERYWHERE))[:1]
        self._bar = KeyBar([*stop, *first], views, more, self.NAME)
        bind(self, desk.keys.of(Area.VIEWS, *areas))

    def compose(self) -> ComposeResult:
        """The frame, and what the view is for."""
        yield self._top
        if self._position is None:
            yield from self.inner()
        else:
            with Horizontal(id="around"):
                yield self._position
                with Inner(id="inner"):
                    yield from self.inner()
        yield self._message
        yield self._bar

    @abstractmethod
    def inner(self) -> ComposeResult:
        """What the view is for."""

    def draw(self, state: MachineState, stopping: bool) -> None:
        """Remember and show how the machine stands.

        Args:
            state: how it stands.
            stopping: the operator has pressed stop and it still moves.
        """
        self.state, self._stopping = state, stopping
        if self.is_mounted:
            self.show(state, stopping)
        self._tell_of(state.cut_short, state.message)

    def _tell_of(self, cut: CutShort | None, message: str) -> None:
        """A program can be gone on with: say so once. A message that is there is worth more."""
        if cut == self._told_of:
            return
        self._told_of = cut
        if cut is not None:
            said = self.desk.keys.said
            sentence = spoken(
                "{name} was cut short in line {line}: {said} goes on with it, {said_2}"
                " lifts the tool.",
                name=cut.name,
                line=cut.line,
                said=said("resume"),
                said_2=said("lift"),
            )
            self.notify(sentence, timeout=10, markup=False)
            if not message:
                self.say(sentence)

    def on_mount(self) -> None:
        """What came before there was anything to show it in."""
        self.show(self.state, self._stopping)
        self.show_said(*self._said)

    @property
    def seen(self) -> "View":
        """The view that is seen now, or that lies below the dialog."""
        lowest = self.app.screen_stack[0] if self.app.screen_stack else self
        return lowest if isinstance(lowest, View) else self

    def say(self, text: str, tone: str = "") -> None:
        """Put this where the last message stands."""
        self._said = text, tone
        if self.is_mounted:
            self.show_said(text, tone)

    @property
    def said(self) -> tuple[str, str]:
        """The last message, and its tone."""
        return self._said

    def show(self, state: MachineState, stopping: bool) -> None:
        """Draw what changed."""
        self._top.show(state, stopping)
        self.set_class(self._top.tells_of_lost_steps, "-lost")
        if self._position is not None and self._position.display:
            self._position.show(state)
        self.show_inner(state)

    @abstractmethod
    def show_inner(self, state: MachineState) -> None:
        """Draw what changed in what the view is for."""

    def take_over(self, before: "View") -> None:
        """Show what the view that was seen before this one knows."""
        self.say(*before._said)
        self._told_of = before._told_of
        self.draw(before.state, before._stopping)

    def show_said(self, text: str, tone: str) -> None:
        """Put this into the message line."""
        self._message.show(text, tone)

    def on_resize(self) -> None:
        """Gauges and bars are as long as there is room."""
        width, height = self.size
        self.set_class(width >= _VAST.width and height >= _VAST.height, "-vast")
        self.call_after_refresh(self.show_again)

    def show_again(self) -> None:
        """As it was shown last, with the room there is now."""
        self.show(self.state, self._stopping)

    def keys_rest(self) -> None:
        """No key was pressed for a while."""

    def keys_unsure(self) -> None:
        """A press came just when a held key would repeat, and nothing came after it."""

    def refuse(self, sentence: str) -> None:
        """Say why something was not done."""
        self.desk.events.add(sentence, Kind.WARNING)
        self.say(sentence, "-warn")
        self.notify(sentence, severity="warning", timeout=5, markup=False)

    def note(self, sentence: str, warning: bool = False) -> None:
        """Say something that is good to know."""
        self.desk.events.add(sentence, Kind.WARNING if warning else Kind.SAID)
        self.say(sentence, "-warn" if warning else "")
        if warning:
            self.notify(sentence, severity="warning", timeout=8, markup=False)

    def expect(self, taken: bool) -> None:
        """Say so if an order was not taken."""
        if not taken:
            self.refuse(BUSY)

    async def on_link_clicked(self, message: Link.Clicked) -> None:
        """A click does what a key does, but is none: the repeat rule starts anew."""
        self.desk.repeats.forget()
        self.desk.strokes.end()
        await self.app.run_action(message.action, self)

    def on_screen_suspend(self) -> None:
        """Another view, or a dialog: nobody sees here what a held key does."""
        self.desk.link.let_go_held()

    # --- commands of every view ------------------------------------------------------------------

    def action_hold(self) -> None:
        """Feed hold, or go on; a job that asks something waits already."""
        if self.state.question:
            self.app.call_later(self.app.run_action, "answer")
        else:
            self.desk.link.hold_or_go_on()

    def action_acknowledge(self) -> None:
        """Take note of an error, or of the job's question."""
        if self.state.status is Status.ERROR:
            self.expect(self.desk.link.acknowledge())
        elif self.state.question:
            self.app.call_later(self.app.run_action, "answer")

    def action_override(self, by_percent: int) -> None:
        """Feed override up or down, or (0) everything as programmed."""
        self.desk.link.override(by_percent)

    def action_rapids(self, by_percent: int) -> None:
        """Override of rapids up or down."""
        self.desk.link.override_rapids(by_percent)

    def action_take_over(self) -> None:
        """Take the machine from a sender, or give it back."""
        said = self.desk.link.take_over()
        if said:
            self.note(said)
        else:
            self.refuse(spoken("No sender is connected."))

    def action_log(self) -> None:
        """Log on or off, also while a job runs."""
        try:
            sentence = self.desk.link.switch_log()
        except FraeseError as error:
            self.refuse(str(error))
            return
        if sentence:
            self.note(sentence)

    def action_theme(self) -> None:
        """Dark, light, high contrast."""
        self.app.theme = after(self.app.theme)

    def action_help(self) -> None:
        """The keys."""
        from fraese.ui.dialogs.help import HelpPage

        self.app.push_screen(HelpPage(self.desk.keys))

    def action_leave(self) -> None:
        """Leave, unless the machine runs."""
        if self.desk.link.moving:
            self.refuse(
                spoken(
                    "The machine runs: stop it first ({said}), or leave at once with {said_2}.",
                    said=STOP.said,
                    said_2=QUIT_AT_ONCE.said,
                )
            )
        else:
            self.app.exit()
