"""What Move does besides jogs: typed lines, positions, the way to zero, offsets, probing."""

from collections.abc import Sequence

from fraese.control.workcommands import go_to_zero
from fraese.phrases import spoken
from fraese.ui.dialogs.byhand import ProbeDialog, SetDialog, TypedDialog
from fraese.ui.dialogs.heldkey import HeldKeyPage
from fraese.ui.dialogs.jograte import JogRateDialog
from fraese.ui.dialogs.macro import MacroDialog
from fraese.ui.dialogs.tables import OffsetsDialog, ToolsDialog
from fraese.ui.macros import Macro
from fraese.ui.newmap import new_map
from fraese.ui.views.afterfaults import AfterFaults
from fraese.ui.views.view import BUSY
from fraese.ui.widths import rate_words


class ByHand(AfterFaults):
    """Opens the dialogs of what is done by hand."""

    def action_type_line(self) -> None:
        """G-code, or a place."""
        desk = self.desk
        self.app.push_screen(TypedDialog(desk.keys, desk.link, desk.tools, desk.history))

    def action_macro(self, at: int) -> None:
        """Show its lines, unless it is to run at once; run it like a typed line."""
        macro = self.desk.macros[at]
        if self.desk.link.moving:
            self.refuse(BUSY)
        elif macro.confirm:
            dialog = MacroDialog(self.desk.keys, macro)
            self.app.push_screen(dialog, lambda meant: self._run(macro) if meant else None)
        else:
            self._run(macro)

    def _run(self, macro: Macro) -> None:
        tools = self.desk.tools
        self.expect(
            self.desk.link.order_of(
                lambda controller: tools.macro(controller, macro.name, macro.text, macro.file)
            )
        )

    def action_set_position(self) -> None:
        """What the present position is to be."""
        self.app.push_screen(SetDialog(self.desk.keys, self.desk.link, self.desk.inputs), self._set)

    def _set(self, line: str | None) -> None:
        if line:
            self.note(spoken("Work position set here: {line}.", line=line.upper()))

    def zero(self, axes: Sequence[str]) -> None:
        """Work zero here, of these axes."""
        self.expect(self.desk.link.zero(axes, self.desk.keys.said("undo_zero")))

    def action_zero_two(self) -> None:
        """Work zero of the two axes of the table."""
        names = [name for name in "xy" if name in self.desk.link.shape.names]
        if names:
            self.zero(names)
        else:
            self.refuse(spoken("This machine has neither X nor Y."))

    def action_go_to_zero(self) -> None:
        """Lift, over, down."""
        self.expect(self.desk.link.order_of(go_to_zero))

    def action_offsets(self) -> None:
        """The nine work offsets."""
        desk = self.desk
        self.app.push_screen(OffsetsDialog(desk.keys, desk.link, desk.link.shape.names))

    def action_measure_held_key(self) -> None:
        """How this terminal repeats a key."""
        if self.desk.link.moving:
            self.refuse(BUSY)
        else:
            self.app.push_screen(HeldKeyPage(self.desk.keys, self.desk.strokes))

    def action_jog_rate(self) -> None:
        """How fast jogs go."""
        link = self.desk.link
        dialog = JogRateDialog(self.desk.keys, link, link.jog_rate.configured_mm_min)
        self.app.push_screen(dialog, self._tell_jog_rate)

    def _tell_jog_rate(self, line: str | None) -> None:
        if line is not None:
            link = self.desk.link
            words = rate_words(link.jog_rate.feed_mm_min, link.shape)
            self.note(spoken("From now on jogs go with {words}.", words=words))

    def action_tools(self) -> None:
        """The tool table."""
        desk = self.desk
        writer = desk.writer
        write, path = (None, "") if writer is None else (writer.write, writer.path)
        self.app.push_screen(ToolsDialog(desk.keys, desk.link, write, path))

    def action_probe(self) -> None:
        """Which cycle."""
        desk = self.desk
        if desk.link.moving:
            self.refuse(BUSY)
        elif desk.tools.cycles(desk.link.shape.names):
            programs = desk.programs
            path = new_map(programs.path if programs.program else None, programs.folder)
            self.app.push_screen(ProbeDialog(desk.keys, desk.link, desk.tools, desk.inputs, path))
        else:
            self.refuse(spoken("There is no probing cycle for this machine."))
