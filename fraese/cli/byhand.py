"""What a person can type while a program waits for him, besides Enter: moves by hand, and a zero.

jog Z -1 F100    move X10 Y5 F300    zero Z    lift
"""

from collections.abc import Callable
from typing import Final

from fraese.axiswords import axes_named, target
from fraese.control.controller import Controller
from fraese.errors import UsageError
from fraese.phrases import phrase

#: Shown behind a question.
HINT: Final = phrase("Enter: go on; by hand: jog Z -1, move X10 Y5, zero Z, lift")


def by_hand(controller: Controller, line: str) -> None:
    """Do what was typed, as the guest of the job that waits.

    Raises:
        UsageError: it is none of these.
        FraeseError: it is refused; nothing has moved.
    """
    word, _, rest = line.strip().partition(" ")
    command = _COMMANDS.get(word.lower())
    if command is None:
        raise UsageError(
            phrase('"{word}" is none of jog, move, zero and lift; Enter goes on.', word=word)
        )
    command(controller, rest)


def _jog(controller: Controller, rest: str) -> None:
    there = target(rest, controller.machine.names)
    if len(there.targets_mm) > 1:
        raise UsageError(phrase("A jog is one axis and a distance, such as jog Z -1."))
    for name, distance_mm in there.targets_mm.items():
        controller.jog(name, distance_mm, feed_mm_min=there.feed_mm_min)


def _move(controller: Controller, rest: str) -> None:
    there = target(rest, controller.machine.names)
    controller.move_to(there.targets_mm, feed_mm_min=there.feed_mm_min)


def _zero(controller: Controller, rest: str) -> None:
    names = axes_named(rest.split(), controller.machine.names)
    if not names:
        raise UsageError(phrase("Say which axis is to be zero here, such as zero Z."))
    controller.set_zero(names)


def _lift(controller: Controller, _rest: str) -> None:
    controller.lift()


_COMMANDS: Final[dict[str, Callable[[Controller, str], None]]] = {
    "jog": _jog,
    "move": _move,
    "zero": _zero,
    "lift": _lift,
}
