"""The job's question: a dialog, until somebody has answered it or moves by hand meanwhile."""

from collections.abc import Callable
from typing import Final

from textual.app import App

from fraese.control.state import MachineState, Status
from fraese.phrases import spoken
from fraese.ui.dialogs.ask import AskDialog, Reply
from fraese.ui.keyrows import KeyTable
from fraese.ui.machinelink import MachineLink

#: An answer has arrived after this time; the same question then is a new one.
_ANSWER_S: Final = 0.3


class Questions:
    """Shows it when it is to be seen.

    Args:
        app: on whose screens.
        keys: the table.
        link: to the machine.
        say: puts a sentence into the message line.
    """

    def __init__(
        self, app: App[None], keys: KeyTable, link: MachineLink, say: Callable[[str], object]
    ) -> None:
        self._app = app
        self._keys = keys
        self._link = link
        self._say = say
        self._state: MachineState | None = None
        # What somebody moves by hand for; the answer comes when he is ready.
        self._put_aside = ""
        self._answer_is_new = False

    def show(self, state: MachineState) -> None:
        """The machine stands so; nothing else is open."""
        self._state, question = state, state.question
        if state.status is not Status.RUN or question not in ("", self._put_aside):
            self._put_aside = ""
        if not question or self._put_aside or self._answer_is_new:
            return
        dialog = AskDialog(self._keys, question, lifts=self._link.lifts)
        self._app.push_screen(dialog, lambda reply: self._replied(question, reply))

    def again(self) -> None:
        """Somebody is ready to answer."""
        self._put_aside = ""
        if self._state is not None:
            self.show(self._state)

    def _replied(self, question: str, reply: Reply | None) -> None:
        if reply is None or self._link.question != question:
            return
        if reply in (Reply.BY_HAND, Reply.LIFT):
            self._put_aside = question
            if reply is Reply.LIFT:
                self._link.lift()
            self._say(
                spoken(
                    "{question} Meanwhile move by hand; {said} goes on.",
                    question=question,
                    said=self._keys.said("acknowledge"),
                )
            )
            return
        self._answer_is_new = True
        self._app.set_timer(_ANSWER_S, self._arrived)
        if reply is Reply.GO_ON:
            self._link.answer()
        else:
            self._link.brake()

    def _arrived(self) -> None:
        """What is asked still, or again, is a new question."""
        self._answer_is_new = False
        if self._state is not None:
            self.show(self._link.state())
