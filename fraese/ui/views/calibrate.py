"""Calibration: routines on the left, on the right what the chosen one does and has found."""

from collections.abc import Callable, Sequence
from dataclasses import replace

from textual.app import ComposeResult
from textual.containers import Horizontal, Vertical, VerticalScroll

from fraese.control.calibration.frequency import FrequencyTest
from fraese.control.calibration.stepsize import StepSizeTest
from fraese.control.controller import Controller
from fraese.control.state import MachineState, Status
from fraese.errors import FraeseError, UsageError
from fraese.phrases import shown, spoken
from fraese.ui.calibrating import ROUTINES, Calibration, Routine, Test
from fraese.ui.dialogs import frequency
from fraese.ui.dialogs.consent import ConsentDialog
from fraese.ui.dialogs.form import Field, FormDialog, Words, number, whole
from fraese.ui.dialogs.reference import Reference, ReferenceDialog
from fraese.ui.dialogs.switches import SwitchPage
from fraese.ui.keyrows import Area
from fraese.ui.keyrows.calibrate import ROUTINE_ROWS
from fraese.ui.shape import AxisShape
from fraese.ui.views.view import BUSY, Desk, View
from fraese.ui.widgets.fact import Fact, Paragraph
from fraese.ui.widgets.findings import finding, proposed
from fraese.ui.widgets.links import Link

#: From so many rows on there is room for what a routine does beside what it has found; and, while
#: nothing was found, for what all of them do.
_ROOMY_ROWS, _GUIDE_ROWS = 32, 45


class CalibrateView(View):
    """Chooses an axis and a routine, asks for what it needs, shows what it finds."""

    AREA = Area.CALIBRATE
    NAME = "calibrate"

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk)
        self.calibration = Calibration(self._order)
        self._form_dialog: FormDialog | None = None
        self._at = 0
        self._routine = ROUTINES["reference"]
        # A way was made, and how far it went is to be asked when it is over.
        self._asks = ""
        self._asked_before: Test | None = None
        self._axes = Fact("", id="calibrate-axes")
        self._tried = Paragraph(id="calibrate-tried")
        self._title = Fact("", id="calibrate-title")
        self._what = Paragraph(id="calibrate-what")
        self._doing = Fact("", id="calibrate-doing")
        self._finding = Paragraph(id="calibrate-finding")
        self._proposal = Paragraph(id="calibrate-proposal")

    def inner(self) -> ComposeResult:
        """Left and right."""
        with Horizontal(id="calibrate"):
            with Vertical(id="routines"):
                yield self._axes
                for row in ROUTINE_ROWS:
                    yield Link(row.action, self._key(row.action), shown(row.title))
                yield self._tried
            with VerticalScroll(id="found", can_focus=False):
                yield self._title
                yield self._what
                yield self._doing
                # First what is to be decided: where there is little room the figures are scrolled.
                yield self._proposal
                yield self._finding

    def _key(self, action: str) -> str:
        return next(row.shown for row in self.desk.keys.of(self.AREA) if row.action == action)

    # --- what is shown ---------------------------------------------------------------------------

    @property
    def axis(self) -> AxisShape:
        """The one that is calibrated."""
        return self.desk.link.shape.axes[self._at]

    def show_inner(self, state: MachineState) -> None:
        """What is done now, and what was found."""
        axes = self.desk.link.shape.axes
        names = " ".join(
            f"[{axis.letter}]" if n == self._at else f" {axis.letter} "
            for n, axis in enumerate(axes)
        )
        self._axes.show(
            spoken(
                "axis {names}  {key} {key_2}",
                names=names,
                key=self._key("axis(-1)"),
                key_2=self._key("axis(1)"),
            )
        )
        self._tried.show(self._tried_words())
        self._title.show(self._routine.title)
        runs = state.status is Status.RUN
        doing = state.job.doing if state.job and runs else ""
        self._doing.show(f"▶ {shown(doing)}" if doing else "", "-run" if doing else "")
        self._show_found(running=runs)
        self._ask_what_was_made(state)

    def _show_found(self, *, running: bool) -> None:
        # A scroll bar may come to it.
        calibration, width = self.calibration, max(30, self.query_one("#found").size.width - 2)
        test = calibration.test if calibration.last == self._routine.name else None
        what = self._what_words(self._routine)
        self._what.show(what if test is None or self.size.height >= _ROOMY_ROWS else "")
        if test is not None:
            lines = finding(test, width, running=running)
        else:
            lines = self._guide() if self.size.height >= _GUIDE_ROWS else []
        self._finding.show("\n".join(lines))
        more: Sequence[str] = ()
        if test is not None and not running:
            more = proposed(calibration, self._key("write"), self._key("proposal(1)"))
        elif running and calibration.frequency_test is test and test is not None:
            more = [
                spoken(
                    "{key} it resonates   {key_2} it stalls   {key_3} take back a mark",
                    key=self._key("mark"),
                    key_2=self._key("mark_stall"),
                    key_3=self._key("unmark"),
                )
            ]
        self._proposal.show("\n".join(more))

    def _tried_words(self) -> str:
        ends, tried = self.desk.link.shape.ends, self.desk.link.switches_tried
        if not ends:
            return ""
        return spoken("switches tried\n") + "\n".join(
            "  ".join(f"{'✓' if end in tried else '·'} {end}" for end in ends[at : at + 2])
            for at in range(0, len(ends), 2)
        )

    def _guide(self) -> list[str]:
        """What the others do: there is room, and nothing has been found."""
        others = [each for each in ROUTINES.values() if each is not self._routine]
        return [line for each in others for line in (each.title, self._what_words(each), "")]

    def _what_words(self, routine: Routine) -> str:
        return routine.what.format(axis=self.axis.letter, home=spoken("its end switch"))

    # --- choosing --------------------------------------------------------------------------------

    def action_axis(self, by: int) -> None:
        """Another axis."""
        self._at = (self._at + by) % len(self.desk.link.shape.axes)
        self.show_again()

    def action_routine(self, name: str) -> None:
        """Show what it does, and ask for what it needs."""
        self._routine = routine = ROUTINES[name]
        self.show_again()
        if self.desk.link.moving:
            self.refuse(BUSY)
        elif routine.by_switch and not self.axis.has_switches:
            self.refuse(
                spoken(
                    "{letter} has no end switches (axes.{name}.end_switches), and {title}"
                    " needs one: choose another axis.",
                    letter=self.axis.letter,
                    name=self.axis.name,
                    title=routine.title.lower(),
                )
            )
        else:
            self._ask(name)

    def _ask(self, name: str) -> None:
        desk, axis, calibration = self.desk, self.axis.name, self.calibration
        if name == "reference":
            self.app.push_screen(ReferenceDialog(desk.keys, desk.link.shape), self._reference)
        elif name == "switches":
            self._switches()
        elif name == "travel":
            self._form(name, (), lambda words: calibration.travel(axis))
        elif name == "gauge":
            self._form(name, (), lambda words: self._asking(name, calibration.gauge(axis)))
        elif name == "steps":
            way = Field("way", spoken("way, {unit}", unit=self.axis.unit), "50")
            self._form(name, [way], self._way)
        elif name == "backlash":
            self._form(
                name,
                [Field("times", spoken("how often"), "3")],
                lambda words: calibration.backlash(
                    axis, whole(words, "times", spoken("how often, as in 3"))
                ),
            )
        elif name == "repeat":
            fields = [
                Field("which", spoken("which one: min or max; empty: home")),
                Field("times", spoken("how often"), "10"),
            ]
            self._form(name, fields, self._repeat)
        else:
            self._form(name, frequency.fields(self.axis), self._frequency)

    def _form(self, name: str, fields: Sequence[Field], begin: Callable[[Words], bool]) -> None:
        """Ask, and begin; what is wrong with a value is said in the dialog, and it stays."""
        routine, inputs = ROUTINES[name], self.desk.inputs

        def remembered(field: str) -> str:
            return f"calibrate {name} {self.axis.name} {field}"

        def check(words: Words) -> bool:
            if begin(words):
                inputs.update({remembered(field): word for field, word in words.items()})
            else:
                dialog.complain(BUSY)
            return False

        fields = [
            replace(field, value=inputs.get(remembered(field.name), field.value))
            for field in fields
        ]
        self._form_dialog = dialog = FormDialog(
            self.desk.keys,
            f"{routine.title}: {self.axis.letter}",
            self._what_words(routine),
            fields,
            check=check,
        )
        self.app.push_screen(dialog)

    def _order(self, order: Callable[[Controller], object]) -> bool:
        """In the machine's thread; what is refused there is said where it was asked for."""

        def go(controller: Controller) -> None:
            try:
                order(controller)
            except FraeseError as error:
                self.call_later(self._refused, str(error))
            else:
                self.call_later(self._begun)

        return self.desk.link.order_of(go)

    def _begun(self) -> None:
        if self._form_dialog is not None:
            self._form_dialog.dismiss({})

    def _refused(self, sentence: str) -> None:
        dialog = self._form_dialog
        if dialog is not None and dialog.is_there:
            dialog.complain(sentence)
        else:
            self.seen.refuse(sentence)

    def _reference(self, wanted: Reference | None) -> None:
        if wanted is not None:
            self.expect(self.desk.link.reference(wanted.axes, measure=wanted.measure))

    def _switches(self) -> None:
        desk = self.desk
        if not desk.link.shape.names_with_switches:
            self.refuse(
                spoken("No axis of this machine has end switches (axes.NAME.end_switches).")
            )
            return
        page = SwitchPage(desk.keys, desk.link.shape, self.state, desk.hand, desk.link.tick_off)
        self.app.push_screen(page, lambda _: self.show_again())

    # --- beginning -------------------------------------------------------------------------------

    def _way(self, words: Words) -> bool:
        way_mm = number(words, "way", spoken("a way, as in 50 or -50"))
        return self._asking("steps", self.calibration.steps(self.axis.name, way_mm))

    def _repeat(self, words: Words) -> bool:
        signs = {"": None, "min": -1, "max": 1}
        if words["which"] not in signs:
            raise UsageError(
                spoken(
                    '"{words}" is no end: min or max, or nothing for the one to which'
                    " {letter} is referenced.",
                    words=words["which"],
                    letter=self.axis.letter,
                )
            )
        times = whole(words, "times", spoken("how often, as in 10"))
        return self.calibration.repeat(self.axis.name, signs[words["which"]], times)

    def _frequency(self, words: Words) -> bool:
        stage, wish, by_switch = frequency.asked(words)
        return self.calibration.frequency(self.axis.name, stage, wish, by_switch=by_switch)

    def _asking(self, name: str, taken: bool) -> bool:
        """When it is over, somebody has read a ruler or a gauge."""
        self._asks = name if taken else ""
        self._asked_before = self.calibration.tests.get(name)
        return taken

    # --- reading ---------------------------------------------------------------------------------

    def _ask_what_was_made(self, state: MachineState) -> None:
        """The way was made: how far was it?"""
        name, test = self._asks, self.calibration.tests.get(self._asks)
        if not name or self.desk.link.busy or self.app.screen is not self:
            return
        if state.status is Status.RUN:
            return
        self._asks = ""
        if test is None or test is self._asked_before:
            return  # it was refused
        if state.status is not Status.OK or "ancelled" in state.message:
            return
        unit = self.axis.unit
        if isinstance(test, StepSizeTest):
            what = spoken(
                "{commanded_mm:g} {unit} were commanded. How far did it really go?",
                commanded_mm=test.commanded_mm,
                unit=unit,
            )
            label = spoken("measured, {unit}; negative: the other way", unit=unit)
        else:
            what, label = (
                spoken("It is back. How far from zero is the gauge?"),
                spoken("it shows, {unit}", unit=unit),
            )
        dialog = FormDialog(
            self.desk.keys, ROUTINES[name].title, what, [Field("read", label)], "OK", self._read
        )
        self.app.push_screen(dialog, lambda _: self.show_again())

    def _read(self, words: Words) -> None:
        value_mm = number(words, "read", spoken("what was read"))
        test = self.calibration.test
        if isinstance(test, StepSizeTest):
            test.measured(test.commanded_mm, value_mm)
        elif test is not None and hasattr(test, "read"):
            test.read(value_mm)

    # --- marks and proposals ---------------------------------------------------------------------

    def action_mark(self) -> None:
        """It resonates."""
        self._marked(lambda test: test.mark(), spoken("resonates"))

    def action_mark_stall(self) -> None:
        """It stalls."""
        self._marked(lambda test: test.mark_stall(), spoken("stalls"))

    def action_unmark(self) -> None:
        """It did not."""
        self._marked(lambda test: test.unmark(), spoken("is not marked any more"))

    def _marked(self, mark: Callable[[FrequencyTest], float | None], word: str) -> None:
        test = self.calibration.frequency_test
        value = None if test is None else mark(test)
        if value is None:
            self.refuse(spoken("Nothing is tried now: marks belong to a frequency test that runs."))
        else:
            self.say(f"{value:g} {word}.")
            self.show_again()

    def action_scroll_found(self, pages: int) -> None:
        """Look further down, or up."""
        self.query_one("#found").scroll_relative(y=8 * pages, animate=False)

    def action_proposal(self, by: int) -> None:
        """Another one that explains the figures."""
        self.calibration.choose(by)
        self.show_again()

    def action_write(self) -> None:
        """Show old and new, and ask."""
        proposal, writer = self.calibration.proposal, self.desk.writer
        if proposal is None or not proposal.changes:
            self.refuse(spoken("There is nothing to write: measure something first."))
        elif self.desk.link.moving:
            self.refuse(BUSY)
        elif writer is None:
            self.refuse(spoken("There is no configuration file to write here."))
        else:
            dialog = ConsentDialog(self.desk.keys, proposal, writer.path)
            self.app.push_screen(dialog, self._write)

    def _write(self, wanted: bool | None) -> None:
        proposal, writer = self.calibration.proposal, self.desk.writer
        if not wanted or proposal is None or writer is None:
            return
        try:
            writer.write(proposal.values())
        except FraeseError as error:
            self.refuse(str(error))
            return
        self.note(
            spoken(
                "Written to {path}: {words}. It counts from the next start.",
                path=writer.path,
                words=proposal.words(),
            )
        )
