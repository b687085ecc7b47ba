"""The machine by hand, and its program.

commands     position and commands
path         position and lines of the program
workspace    both, where there is room: position left, right the path over its lines
"""

from typing import Final

from textual.app import ComposeResult
from textual.containers import Container, Horizontal
from textual.geometry import Size

from fraese.control.state import MachineState
from fraese.phrases import phrase, shown, spoken
from fraese.ui.dialogs.confirm import ConfirmDialog
from fraese.ui.dialogs.goto import GoToDialog
from fraese.ui.dialogs.page import Page
from fraese.ui.dialogs.reference import Reference, ReferenceDialog
from fraese.ui.dialogs.switches import SwitchPage
from fraese.ui.heldkeys import Stroke
from fraese.ui.keyrows import Area
from fraese.ui.keyrows.axes import is_jog
from fraese.ui.programs import Program
from fraese.ui.views.byhand import ByHand
from fraese.ui.views.running import RunsPrograms
from fraese.ui.views.view import BUSY, Desk
from fraese.ui.widgets.commands import CommandList
from fraese.ui.widgets.fact import Fact, Flowing
from fraese.ui.widgets.jogpad import JogButton, JogPad
from fraese.ui.widgets.links import Link
from fraese.ui.widgets.macrowords import few_words
from fraese.ui.widgets.position import PositionPanel
from fraese.ui.widgets.programpane import ProgramPane
from fraese.ui.widgets.status import JobLine, WidthBar
from fraese.ui.widths import FIRST_WIDTH, rate_words, widths

PICTURES: Final = ("commands", "path")
#: Strokes that set nothing in motion, and why.
_SPENT: Final = phrase("Nothing more is jogged by this key until it is let go and pressed again.")
_QUEUED: Final = phrase(
    "Presses that came all at once, late, are left out: only the first one counts."
)
_UNSURE: Final = phrase(
    "A press came just when a held key would repeat, and is left out: press again."
)
#: From this size on there is room for position and program side by side.
_WORKSPACE: Final = Size(120, 40)


class MachineView(RunsPrograms, ByHand):
    """Position, status, commands and path; jogs, goes, references, zeroes, runs programs."""

    AREA = Area.MACHINE
    ALSO = (Area.RUNNING,)
    NAME = "move"
    IS_BESIDE_POSITION = False

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk)
        shape, keys = desk.link.shape, desk.keys
        self.add_class(PICTURES[0])
        self._choice = widths(shape)
        self._width = FIRST_WIDTH
        self._passed_over = False
        self._program = Flowing(spoken("no program"), id="program")
        self._panel = PositionPanel(shape)
        width_keys = [row for row in keys.commands if row.action.startswith("set_width")]
        rate_key = next(row for row in keys.commands if row.action == "jog_rate")
        self._widths = WidthBar(self._choice, width_keys, rate_key)
        self._macros = [row for row in keys.commands if row.action.startswith("macro(")]
        # Where their line has no room they stand, in few words, in place of the title.
        self.set_class(bool(self._macros), "-macros")
        self._pane = ProgramPane(desk.programs, self.state, keys.said("open"))
        self._job = JobLine(keys.said("acknowledge"))

    def inner(self) -> ComposeResult:
        """Top to bottom."""
        with Container(id="body"):
            yield self._panel
            yield self._pane
        yield self._widths
        macros = self._macros
        if macros:
            with Horizontal(id="macros"):
                yield Fact(spoken("macros"), classes="heading")
                yield from (Link(row.action, row.shown, row.title) for row in macros)
        with Horizontal(id="hand"):
            yield JogPad(self.desk.link.shape.axes)
            # What the pad does needs no row.
            yield CommandList([row for row in self.desk.keys.listed if not is_jog(row)])
        with Horizontal(id="job-line"):
            yield self._job
            if macros:
                said = few_words(macros, self.desk.keys.palette)
                yield Link("app.command_palette", spoken("macros"), said, id="macros-few")
            names = ("fraese", shown(self.desk.machine_name))
            yield Fact(" · ".join(filter(None, names)), id="title")
            yield self._program

    def on_mount(self) -> None:
        """What was given at the start."""
        self._widths.show(self._width, 1)
        if self.desk.programs.path is not None:
            self.load(self.desk.programs.path)
        self.offer_position()

    def on_resize(self) -> None:
        """Both pictures at once, where there is room for them."""
        width, height = self.size
        self.set_class(width >= _WORKSPACE.width and height >= _WORKSPACE.height, "-workspace")

    def on_screen_suspend(self) -> None:
        """What a dialog covers is seen among the facts."""
        top = self.app.screen
        self.set_class(top.COVERS if isinstance(top, Page) else top is not self, "-covered")
        self.call_after_refresh(self.show_again)

    def on_screen_resume(self) -> None:
        """They are seen again."""
        self.remove_class("-covered")
        self.call_after_refresh(self.show_again)

    # --- what is shown ---------------------------------------------------------------------------

    @property
    def picture(self) -> str:
        """One of ``PICTURES``."""
        return next(name for name in PICTURES if self.has_class(name))

    def show_picture(self, name: str) -> None:
        """Change to this one."""
        self.remove_class(*PICTURES)
        self.add_class(name)
        # What was hidden has not been kept up to date.
        self.call_after_refresh(self.show_again)

    def show_inner(self, state: MachineState) -> None:
        """Draw what changed."""
        self._panel.show(state)
        link = self.desk.link
        self._widths.show_rate(rate_words(link.jog_rate.feed_mm_min, link.shape))
        self._show_job()
        self._pane.show(state)

    def _show_job(self) -> None:
        waiting = self.desk.link.jogs_waiting
        self._job.show_job(self.state, waiting, programs=not self.has_class("-workspace"))

    def keys_rest(self) -> None:
        """The next press counts single again."""
        self._widths.show(self._width, 1)

    def keys_unsure(self) -> None:
        """It is not done, and not passed over in silence."""
        if self._passed_over:
            self.say(_UNSURE)

    def action_picture(self) -> None:
        """The other one."""
        at = PICTURES.index(self.picture)
        self.show_picture(PICTURES[(at + 1) % len(PICTURES)])

    def action_scroll_path(self, pages: int) -> None:
        """Look elsewhere in the program."""
        self._pane.listing.scroll_pages(pages)

    # --- moving ----------------------------------------------------------------------------------

    def action_jog(self, axis: str, sign: int) -> None:
        """One press."""
        width_mm = self._choice[self._width].mm
        factor = self.desk.repeats.factor
        self._widths.show(self._width, factor)
        steps = sign * factor if width_mm is None else 0
        link, strokes = self.desk.link, self.desk.strokes
        self._passed_over = strokes.stroke is Stroke.REPEAT
        if strokes.stroke is Stroke.QUEUED:
            self.refuse(_QUEUED)
        elif strokes.stroke is Stroke.SPENT:
            self.say(_SPENT)
        elif width_mm is None:
            self.expect(link.jog(axis, steps=steps, held=bool(strokes.holds)))
        elif strokes.stroke is Stroke.TAP:
            self.expect(link.jog(axis, mm=sign * width_mm))
        elif strokes.stroke is Stroke.HOLD:
            silence_s = strokes.manners.silence_s
            self.expect(link.hold_jog(axis, sign, silence_s, strokes.at_s))
        else:
            link.still_held(strokes.at_s)
        self._show_job()

    def on_jog_button_pressed(self, message: JogButton.Pressed) -> None:
        """A click is a press of the key, but no key."""
        if type(message) is JogButton.Pressed:
            self.desk.repeats.forget()
            self.desk.strokes.end()
            self.action_jog(message.axis, message.sign)

    def on_jog_button_held(self, message: JogButton.Held) -> None:
        """It runs until it is let go."""
        self.expect(self.desk.link.hold_jog(message.axis, message.sign))

    def on_jog_button_still_held(self) -> None:
        """The one who holds it is still there."""
        self.desk.link.still_held()

    def on_jog_button_let_go(self) -> None:
        """Brake."""
        self.desk.link.let_go_held()

    def action_width(self, by: int) -> None:
        """The next width, or the one before."""
        self.action_set_width((self._width + by) % len(self._choice))

    def action_set_width(self, index: int) -> None:
        """This width."""
        self._width = index
        self._widths.show(index, 1)

    def action_go_to(self) -> None:
        """Ask where to."""
        desk = self.desk
        self.app.push_screen(GoToDialog(desk.keys, desk.link, desk.inputs))

    def action_reference(self) -> None:
        """Ask which axes."""
        desk = self.desk
        self.app.push_screen(ReferenceDialog(desk.keys, desk.link.shape), self._reference)

    def _reference(self, wanted: Reference | None) -> None:
        if wanted is not None:
            self.expect(self.desk.link.reference(wanted.axes, measure=wanted.measure))

    def action_zero(self, axis: str) -> None:
        """Work zero here, of one axis or (empty) all."""
        self.zero((axis,) if axis else self.desk.link.shape.names)

    def action_lift(self) -> None:
        """Out of the way."""
        self.expect(self.desk.link.lift())

    def action_undo_zero(self) -> None:
        """Work zero as it was."""
        self.expect(self.desk.link.undo_zero())

    # --- end switches ----------------------------------------------------------------------------

    def action_ignore(self) -> None:
        """Contacts stop the motors, or do not: that is asked for twice."""
        if self.state.switch_ignored:
            self.expect(self.desk.link.ignore_switches(False))
            return
        dialog = ConfirmDialog(
            self.desk.keys,
            spoken("Ignore the end switches"),
            spoken(
                "Nothing will stop an axis at its end any more: the motors run against it,"
                " and lose steps. Only for trying things out."
            ),
            spoken("Ignore them"),
        )
        self.app.push_screen(dialog, self._ignore)

    def _ignore(self, meant: bool | None) -> None:
        if meant:
            self.expect(self.desk.link.ignore_switches(True))

    def action_switch_test(self) -> None:
        """Each switch by hand."""
        desk = self.desk
        if desk.link.moving:
            self.refuse(BUSY)
            return
        if not desk.link.shape.names_with_switches:
            self.refuse(
                spoken("No axis of this machine has end switches (axes.NAME.end_switches).")
            )
            return
        link = desk.link
        page = SwitchPage(desk.keys, link.shape, self.state, desk.hand, link.tick_off)
        self.app.push_screen(page)

    # --- programs --------------------------------------------------------------------------------

    def show_program(self, program: Program) -> None:
        """This one is loaded now."""
        self._program.show(program.name)
        self.show_picture("path")

    def show_line(self, line: int) -> None:
        """Look at this line of it."""
        self.show_picture("path")
        self._pane.listing.show_line(line)
