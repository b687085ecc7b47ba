"""A few values, asked before something is done."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from textual.app import ComposeResult
from textual.containers import Horizontal
from textual.widgets import Input

from fraese.errors import FraeseError, UsageError
from fraese.phrases import spoken
from fraese.ui.dialogs.dialog import Dialog
from fraese.ui.keyrows import Area, KeyTable
from fraese.ui.widgets.fact import Fact

#: As words, by the names of the fields.
Words = Mapping[str, str]
_LONGEST = 40


@dataclass(frozen=True, slots=True)
class Field:
    """One value.

    Attributes:
        name: of it.
        label: what is asked, with its unit.
        value: offered.
    """

    name: str
    label: str
    value: str = ""


class FormDialog(Dialog[Words]):
    """What will be done, and the values for it.

    Args:
        keys: the table.
        heading: what it is about.
        what: what will be done.
        fields: the values.
        yes: word on the button.
        check: refuses values by raising; the dialog stays then. ``False``: whoever checks closes
            the dialog, or complains, as soon as he knows.
    """

    AREA = Area.FORM

    def __init__(
        self,
        keys: KeyTable,
        heading: str,
        what: str,
        fields: Sequence[Field] = (),
        yes: str = spoken("Start"),
        check: Callable[[Words], bool | None] = lambda words: None,
    ) -> None:
        super().__init__(keys)
        self.HEADING, self.YES = heading, yes
        self._what = what
        self._fields = tuple(fields)
        self._check = check

    def inner(self) -> ComposeResult:
        """What will be done; a line for each value."""
        yield Fact(self._what, classes="question")
        for number, field in enumerate(self._fields):
            with Horizontal(classes="field" if number else "field first"):
                yield Fact(field.label, classes="field-label")
                yield Input(
                    field.value, id=f"field-{field.name}", max_length=_LONGEST, compact=True
                )

    def on_mount(self) -> None:
        """The first value may be typed at once; without values Enter starts."""
        self.set_focus(
            self.query(Input).first() if self._fields else self.query_one("#yes"),
        )

    def action_accept(self) -> None:
        """Take the values, or say what is wrong with them."""
        words = {
            field.name: self.query_one(f"#field-{field.name}", Input).value.strip()
            for field in self._fields
        }
        self.complain("")
        try:
            is_over = self._check(words)
        except FraeseError as error:
            self.complain(str(error))
            return
        if is_over is not False:
            self.dismiss(words)


def number(words: Words, name: str, what: str) -> float:
    """A value as a number.

    Raises:
        UsageError: if it is none.
    """
    text = words[name].replace(",", ".")
    try:
        return float(text)
    except ValueError:
        raise UsageError(
            spoken('"{words}" is no number: give {what}.', words=words[name], what=what)
        ) from None


def number_or_none(words: Words, name: str, what: str) -> float | None:
    """The same; None where nothing is given.

    Raises:
        UsageError: if it is no number.
    """
    return number(words, name, what) if words[name] else None


def whole(words: Words, name: str, what: str) -> int:
    """A value as a whole number.

    Raises:
        UsageError: if it is none.
    """
    try:
        return int(words[name])
    except ValueError:
        raise UsageError(
            spoken('"{words}" is no whole number: give {what}.', words=words[name], what=what)
        ) from None
