"""Cards of this program as facts for the device: one function for each.

Another card has such a function in its record, if the device can play it: ``kinds/card.py``.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

from fraese.errors import PortError
from fraese.motor.bridge.cards import CardFacts, Lamp, Line, nearest_rate
from fraese.motor.bridge.constants import CARD_CLOCKS, CARD_PHASES
from fraese.motor.cards.control import OutputPin
from fraese.motor.cards.smc1500 import SmcCard
from fraese.motor.cards.stepdir import ACTIVE_PIN, BOOST_PIN, StepDirCard
from fraese.motor.phases import MOTZERO, motor_bits
from fraese.motor.pins import CONTROL_PINS
from fraese.motor.seams import Card
from fraese.motor.switches import SwitchInput
from fraese.phrases import phrase


def pin_line(pin: int, active_high: bool = True) -> Line:
    """A control pin as a bit of the register, and the bit's value when the line is on."""
    bit, inverted = CONTROL_PINS[pin]
    return Line(bit, bit if active_high != inverted else 0)


def _outputs(pins: Sequence[OutputPin]) -> tuple[Line, ...]:
    """An output with pulses is switched by its power: as a line it is none."""
    return tuple(Line() if pin.pulses_hz else pin_line(pin.pin, pin.active_high) for pin in pins)


def _lamp(pins: Sequence[OutputPin]) -> Lamp | None:
    pulsed = [pin for pin in pins if pin.pulses_hz]
    return Lamp(nearest_rate(pulsed[0].pulses_hz), pulsed[0].active_high) if pulsed else None


def smc_facts(card: SmcCard) -> CardFacts:
    """Of a phase card: its tables."""
    return CardFacts(
        kind=CARD_PHASES,
        motors=card.motors,
        table=card.table,
        hold=card.hold_table,
        control_rest=card.lines.rest,
        strobe=CONTROL_PINS[1].bit,
        outputs=_outputs(card.lines.outputs),
        motor_bits=tuple(motor_bits(socket) for socket in card.sockets),
        off=MOTZERO,
        lamp=_lamp(card.lines.outputs),
        beat_cycles=card.beat_cycles,
    )


def stepdir_facts(card: StepDirCard) -> CardFacts:
    """Of step/direction drives: their lines."""
    return CardFacts(
        kind=CARD_CLOCKS,
        motors=card.motors,
        control_rest=card.lines.rest,
        clock_rest=card.clock_rest,
        forward_high=card.forward_high,
        motor_bits=card.lines_of,
        active=pin_line(ACTIVE_PIN),
        boost=pin_line(BOOST_PIN),
        outputs=_outputs(card.lines.outputs),
        enable=card.enable_mask,
        lamp=_lamp(card.lines.outputs),
        pulse_cycles=card.pulse_cycles,
        setup_cycles=card.setup_cycles,
        duty_q16=card.duty_q16,
        beat_cycles=card.beat_cycles,
    )


#: For who has a card and no configuration.
FACTS: Final[Mapping[type, Callable[[Any], CardFacts]]] = {
    SmcCard: smc_facts,
    StepDirCard: stepdir_facts,
}


def facts_of(card: Card) -> CardFacts:
    """What the device must know of a card of ours.

    Raises:
        PortError: if it cannot play such a card.
    """
    facts = FACTS.get(type(card))
    if facts is None:
        raise PortError(
            phrase("The bridge cannot play a card of the kind {name}.", name=type(card).__name__)
        )
    return facts(card)


def card_facts(
    facts: CardFacts,
    switch: SwitchInput,
    *,
    settle_cycles: int,
    safe_outputs: int,
    silence_ms: int,
) -> CardFacts:
    """What the device is told.

    Args:
        facts: of the card, by itself.
        switch: the shared end-switch input.
        settle_cycles: wait after energising.
        safe_outputs: outputs that are off whenever the motors stand.
        silence_ms: longest silence of the host.
    """
    return replace(
        facts,
        safe=safe_outputs,
        settle_cycles=settle_cycles,
        switch_mask=switch.mask,
        switch_value=switch.closed_value,
        readings=switch.readings,
        silence_ms=silence_ms,
    )
