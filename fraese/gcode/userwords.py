"""M100 to M199, to which somebody else has given a meaning.

Rule 1: a word is a row and a method: the method is called when its line is carried out, and gives
        canonical moves.
Rule 2: it may switch outputs, wait, speak, and have a program carried out. It does not move: where
        the tool is, the interpreter knows, and nobody else changes it.
Rule 3: whatever its method raises is an error of the line, in one sentence.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Final, NamedTuple

from fraese.errors import FraeseError, ProgramError
from fraese.gcode.canon import Command, Dwell, Message, Move, Output
from fraese.phrases import phrase

MAY: Final = (Output, Dwell, Message, Command)


class Call(NamedTuple):
    """A word as it stands in a program.

    Attributes:
        line: its line.
        code: 100 to 199.
        p, q: what stands beside it; None: nothing.
    """

    line: int
    code: int
    p: float | None
    q: float | None


@dataclass(frozen=True)
class Word:
    """What a code means.

    Attributes:
        moves: what it does, see rule 2.
    """

    moves: Callable[[Call], Iterable[Move]]


def no_word(_code: int) -> Word | None:
    """Nobody has given any of them a meaning."""
    return None


def carried_out(word: Word, call: Call) -> Iterator[Move]:
    """The moves of a word.

    Raises:
        ProgramError: its method fails, or gives what it may not.
    """
    try:
        for move in word.moves(call):
            if not isinstance(move, MAY):
                raise ProgramError(
                    phrase(
                        "M{code} may switch outputs, wait and speak; it has made a {name}",
                        code=call.code,
                        name=type(move).__name__,
                    )
                )
            yield move
    except FraeseError:
        raise
    except Exception as error:  # Whatever a stranger's method may raise.
        raise ProgramError(
            phrase(
                "M{code} has failed: {error}",
                code=call.code,
                error=f"{type(error).__name__}: {error}",
            )
        ) from error
