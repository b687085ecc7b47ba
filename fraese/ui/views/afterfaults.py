"""What a view does about what a fault has left: a program cut short, a position in doubt."""

from abc import abstractmethod
from pathlib import Path

from fraese.control.asleft import Left
from fraese.control.controller import Controller
from fraese.phrases import spoken
from fraese.ui.dialogs.crash import Answer, CrashDialog
from fraese.ui.dialogs.resume import ResumeDialog
from fraese.ui.programs import Program, Resumption
from fraese.ui.views.view import View


class GoesOn(View):
    """Goes on with programs that were cut short."""

    @abstractmethod
    def put(self, path: Path, program: Program) -> None:
        """This one is loaded now, and shown."""

    def action_resume(self) -> None:
        """Show how the program that was cut short would be gone on with."""

        def ask(controller: Controller) -> None:
            self.call_later(self._show_resumption, self.desk.programs.resume(controller))

        self.expect(self.desk.link.order_of(ask))

    def _show_resumption(self, resumption: Resumption) -> None:
        def decided(back: int | None) -> None:
            if back is not None:
                self._go_on(resumption, back)
            else:
                resumption.program.close()

        self.app.push_screen(ResumeDialog(self.desk.keys, resumption), decided)

    def _go_on(self, resumption: Resumption, back: int) -> None:
        self.desk.programs.give_up()
        self.put(resumption.path, resumption.program)
        taken = self.desk.link.order_of(lambda controller: resumption.start(controller, back))
        self.expect(taken)


class AfterFaults(View):
    """Settles what a crash has left of the position."""

    @abstractmethod
    def action_reference(self) -> None:
        """Ask which axes."""

    def offer_position(self) -> None:
        """At the start: what a crash has left is settled first, if there was one."""
        left = self.desk.link.left_at_start
        if left is not None:
            self._show_left(left)

    def action_after_crash(self) -> None:
        """What is known of the position, and what to do about it."""

        def tell(left: Left | None) -> None:
            self.call_later(self._show_left, left)

        self.expect(self.desk.link.ask_what_was_left(tell))

    def _show_left(self, left: Left | None) -> None:
        if left is None:
            self.note(spoken("No crash has put the position in doubt."))
            return
        self.say(left.known, "-warn")
        self.app.push_screen(CrashDialog(self.desk.keys, left), self._decided)

    def _decided(self, answer: Answer | None) -> None:
        if answer is Answer.REFERENCE:
            self.action_reference()
        elif answer is Answer.AS_LEFT:
            self.expect(self.desk.link.take_as_left())
