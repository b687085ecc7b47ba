"""What the machine's thread tells the app."""

from textual.message import Message


class StateChanged(Message):
    """There is something to take from the feed."""


class Alarmed(Message):
    """A job ended with an error."""

    def __init__(self, sentence: str) -> None:
        super().__init__()
        self.sentence = sentence


class Refused(Message):
    """A command was refused; nothing has moved."""

    def __init__(self, sentence: str) -> None:
        super().__init__()
        self.sentence = sentence


class Noted(Message):
    """Something to know."""

    def __init__(self, sentence: str, warning: bool = False) -> None:
        super().__init__()
        self.sentence = sentence
        self.warning = warning
