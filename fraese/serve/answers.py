"""Answers to lines, and what else a sender is told of what a line has led to."""

from collections.abc import Callable

from fraese.gcode import canon
from fraese.machine import Machine
from fraese.serve import settings
from fraese.serve.codes import Code
from fraese.serve.inbox import Inbox, Sent
from fraese.serve.report import Axes, as_message
from fraese.serve.system import System


class Answers:
    """What is answered.

    Args:
        machine: its axes.
        inbox: what waits.
        system: grbl's own commands.
        say: tells the sender a line.
    """

    def __init__(
        self, machine: Machine, inbox: Inbox, system: System, say: Callable[[str], object]
    ) -> None:
        self._axes = Axes(machine)
        self._inbox = inbox
        self._system = system
        self._say = say

    def answer(self, line: Sent, code: Code, said: str) -> None:
        """A line is through: a sentence, if there is one, and the number."""
        if said:
            self._say(as_message(said))
        text = f"error:{code:d}" if code else "ok"
        self._say(f">{line.text}:{text}" if line.is_own else text)

    def inline(self, line: Sent) -> bool:
        """A command among the lines of a job; False: it has to wait for a standstill."""
        if not self._system.is_inline(line):
            return False
        if self._inbox.take(line):
            self.answer(line, *self._system.inline(line))
        return True

    def saw(self, move: canon.Move, facts: canon.Facts | None) -> None:
        """A move that has something to tell."""
        if type(move) is canon.Probe and facts is not None:
            at_mm = facts.position_mm if facts.contact_mm is None else facts.contact_mm
            inches = bool(self._system.value(settings.INCHES))
            where = self._axes.written(at_mm, inches=inches)
            self._system.probed = f"[PRB:{where}:{int(facts.touched)}]"
            self._say(self._system.probed)
        elif type(move) is canon.End:
            self._say("[MSG:Pgm End]")
