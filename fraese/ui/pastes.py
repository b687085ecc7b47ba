r"""Text that was pasted into a terminal which does not say so.

    read at once   g a r b a g e Enter X   -->   Paste("garbage\nX")
    typed          g | 5 | Enter           -->   as it came

As keys, it would be commands: zero here, reference there. As a paste it goes into the input that
has the focus, and nowhere else.
"""

from collections.abc import Iterator, Sequence
from typing import Final

from textual.events import Key, Paste
from textual.message import Message

#: So many letters come at once from no fingers.
_LETTERS: Final = 4
#: Keys that may stand between letters of a text.
_BETWEEN: Final = {"enter": "\n", "tab": "\t"}


def with_pastes(messages: Sequence[Message]) -> Iterator[Message]:
    """What was read at once, texts in it put together; a key behind a text stays a key."""
    run: list[Key] = []
    for message in messages:
        if isinstance(message, Key) and (message.is_printable or (run and message.key in _BETWEEN)):
            run.append(message)
            continue
        yield from _put_together(run)
        run = []
        yield message
    yield from _put_together(run)


def _put_together(run: list[Key]) -> Iterator[Message]:
    end = len(run)
    while end and not run[end - 1].is_printable:
        end -= 1
    letters = [key.character or "" for key in run[:end] if key.is_printable]
    # One letter many times is a key that is held.
    if len(letters) < _LETTERS or len(set(letters)) == 1:
        yield from run
        return
    yield Paste("".join(_BETWEEN.get(key.key) or key.character or "" for key in run[:end]))
    yield from run[end:]
