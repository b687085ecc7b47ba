"""What the rest of the house asks of a card: one record.

    configuration   sockets, taken_pins                        what may be configured
    plant           make, turn_steps, word                     what drives the motors
    simulated mill  electronics, stepping, divides             the same as seen from the plug
    waveforms       pins, decoder                              what hangs on which line
    doctor          limit_hz                                   how fast it can be asked to be
    bridge          bridge                                     what a microcontroller must know

Rule 1: a record is found by its name in ``peers.py: CARDS``. Nobody asks a card for its name.
Rule 2: what has a default is what many cards do not need.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from fraese.config import Config
from fraese.errors import ConfigError
from fraese.motor.bridge.cards import CardFacts
from fraese.motor.electronics import Electronics
from fraese.motor.meaning import Decoder
from fraese.motor.mill import Mill
from fraese.motor.phases import FULL_STEPS_A_TURN, FULL_STEPS_PER_REV
from fraese.motor.seams import Card, Clock
from fraese.peers import CARDS
from fraese.phrases import phrase


class Stepping(NamedTuple):
    """What one step of a card is to a motor.

    Attributes:
        steps_in_turn: in which the field makes one electrical turn (four full steps).
        sense: which way a positive step turns the field, 1 as ``MOTRUN`` does, or -1.
    """

    steps_in_turn: int
    sense: int = 1


def _nothing(_config: Config) -> Iterator[tuple[str, str]]:
    return iter(())


def _no_text(_config: Config) -> str:
    return ""


def _no_decoder(_config: Config) -> Decoder | None:
    return None


def turns_of_drives(config: Config) -> tuple[int, ...]:
    """Turns of drives that were switched off too: they may begin anew anywhere in their turn.

    What motor is turned is not known: taken is the one with the shorter turns.
    """
    a_rev = max(FULL_STEPS_PER_REV) // FULL_STEPS_A_TURN
    return tuple(axis.steps_per_rev // a_rev for axis in config.axes.table.values())


@dataclass(frozen=True)
class CardKind:
    """One card.

    Attributes:
        about: what it is, half a sentence, for ``fraese config init``.
        sockets: motors that it drives at most.
        make: the card as configured; raises ConfigError.
        electronics: its counterpart on the simulated mill; is given the mill, its clock, the
            configuration, and in which socket each motor of the mill hangs.
        stepping: what a step is to the motor of an axis of the simulated mill, by its name.
        limit_hz: steps a second that it can follow at most.
        pins: what hangs on the pins of the plug, one word each, for waveforms.
        bridge: what a microcontroller must be told of it to play it; None: it cannot.
        taken_pins: control pins that it has for itself; the others may be outputs.
        turn_steps: per axis, steps in one electrical turn of its motor, or fewer.
        decoder: quantities behind the lines; None: there are none.
        word: what gives its steps their meaning, beside its name; changed, positions are lost.
        misfits: what of a configuration does not suit it and is not refused: axis, half a sentence.
        described: a sentence about it for ``fraese config check``.
        divides: its drives have switches that divide a full step, which nothing here can see.
    """

    about: str
    sockets: int
    make: Callable[[Config], Card]
    electronics: Callable[[Mill, Clock, Config, Sequence[int]], Electronics]
    stepping: Callable[[Config, str], Stepping]
    limit_hz: Callable[[Config], float]
    pins: Callable[[Config], Mapping[int, str]]
    bridge: Callable[[Any], CardFacts] | None = None
    taken_pins: frozenset[int] = frozenset()
    turn_steps: Callable[[Config], tuple[int, ...]] = turns_of_drives
    decoder: Callable[[Config], Decoder | None] = _no_decoder
    word: Callable[[Config], str] = _no_text
    misfits: Callable[[Config], Iterator[tuple[str, str]]] = _nothing
    described: Callable[[Config], str] = _no_text
    divides: bool = False

    def facts(self, card: Card, kind: str) -> CardFacts:
        """What a microcontroller is told of a card of this kind.

        Args:
            card: as ``make`` made it.
            kind: its name, for the sentence.

        Raises:
            ConfigError: if it cannot play such a card.
        """
        if self.bridge is None:
            raise ConfigError(
                phrase(
                    'card.kind "{kind}" is not on the bridge: its firmware cannot play this card;'
                    " a parallel port and the simulated mill can.",
                    kind=kind,
                )
            )
        return self.bridge(card)


def card_kind(config: Config) -> CardKind:
    """The record of the card as configured."""
    found = CARDS.record(config.card.kind)
    assert isinstance(found, CardKind)
    return found


def card_of(config: Config) -> Card:
    """The card as configured.

    Raises:
        ConfigError: if it cannot be built so.
    """
    return card_kind(config).make(config)
