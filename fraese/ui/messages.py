"""What the machine's thread tells the app."""

from textual.message import Message


class StateChanged(Message):
    """There is something to take from the feed."""


class Alarmed(Message):
    """A job ended with an error.

    Args:
        sentence: what happened.
        number: of the alarm; 0: the job was refused on its way.
        advice: what to do now; empty: the sentence says it.
    """

    def __init__(self, sentence: str, number: int = 0, advice: str = "") -> None:
        super().__init__()
        self.sentence = sentence
        self.number = number
        self.advice = advice


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


class KeyUp(Message):
    """A key was let go, as the terminal tells."""

    def __init__(self, key: str) -> None:
        super().__init__()
        self.key = key
