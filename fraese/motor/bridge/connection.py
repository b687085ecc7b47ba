"""Finding the device and telling it everything; and again, when it was lost.

    open line -> greet -> can it play this card? -> tables, card, phases, switch mode, override

Rule 1: a device knows nothing: whatever it should know is told in every session anew.
Rule 2: all of it is done in steps of some milliseconds: whoever polls while a lost device is looked
        for is not kept waiting.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Final

from fraese import alarms
from fraese.errors import PortError
from fraese.motor.bridge import constants as c
from fraese.motor.bridge.cards import CLOCK_LINES, CardFacts, card_commands
from fraese.motor.bridge.codec import Hello
from fraese.motor.bridge.line import OpenLine
from fraese.motor.bridge.session import Session, greeting
from fraese.motor.bridge.stepwise import Steps
from fraese.motor.seams import Clock, IdleLevel, SwitchMode
from fraese.phrases import phrase

LEVELS: Final[Mapping[IdleLevel, bytes]] = {IdleLevel.OFF: b"\x00", IdleLevel.HOLD: b"\x01"}
MODES: Final[Mapping[SwitchMode, bytes]] = {SwitchMode.STOP: b"\x00", SwitchMode.IGNORE: b"\x01"}


@dataclass(frozen=True)
class Connection:
    """How the device is reached.

    Attributes:
        open_line: opens the line.
        clock: for waiting.
        facts: the card.
        name: of the line, for sentences.
        baud: its rate, likewise.
        patience_s: so long is a greeting repeated.
    """

    open_line: OpenLine
    clock: Clock
    facts: CardFacts
    name: str
    baud: int
    patience_s: float

    def opening(
        self, phases: tuple[int, ...], mode: SwitchMode, override_q8: int, *, again: bool
    ) -> Steps[Session]:
        """Greet the device and tell it everything, step by step.

        Args:
            phases: of the motors.
            mode: what an end switch does.
            override_q8: feed override.
            again: the device was there before, at this rate.

        Raises:
            PortError: if it is not there, or cannot play this card.
        """
        session = yield from greeting(
            self.open_line(),
            self.clock,
            self.name,
            self.baud,
            self.patience_s,
            finds_rate=not again,
        )
        try:
            yield from self.telling(session, phases, mode, override_q8)
        except BaseException:
            session.hang_up()
            raise
        return session

    def telling(
        self, session: Session, phases: tuple[int, ...], mode: SwitchMode, override_q8: int
    ) -> Steps[None]:
        """Tell a device that was greeted everything, step by step.

        Raises:
            PortError: if it cannot play this card, or is lost.
        """
        self._require_able(session)
        for kind, payload in self._all(phases, mode, override_q8):
            yield from session.commanding(kind, payload)

    def _all(
        self, phases: tuple[int, ...], mode: SwitchMode, override_q8: int
    ) -> Iterator[tuple[int, bytes]]:
        yield from card_commands(self.facts)
        indices = [phase & 0xFF for phase in phases] + [0] * c.MOTORS_MAX
        yield c.KIND_PHASES, bytes(indices[: c.MOTORS_MAX])
        yield c.KIND_MODE, MODES[mode]
        yield c.KIND_OVERRIDE, override_q8.to_bytes(2, "little")

    def _require_able(self, session: Session) -> None:
        hello, facts = session.hello, self.facts
        able = hello.phase_cards if facts.kind == c.CARD_PHASES else hello.clock_cards
        if able and facts.motors <= hello.motors and len(facts.table) <= hello.table_max:
            self._require_sockets(hello)
            self._require_lamp(hello)
            self._require_inputs(hello)
            return
        raise PortError(
            phrase(
                "The bridge on {name} ({board}, firmware {firmware}.{firmware_2}) cannot"
                " play this card: it drives {motors} motors with tables of {table_max}"
                " entries.",
                name=self.name,
                board=hello.board,
                firmware=hello.firmware[0],
                firmware_2=hello.firmware[1],
                motors=hello.motors,
                table_max=hello.table_max,
            ),
            alarms.BRIDGE_UNFIT,
        )

    def _require_lamp(self, hello: Hello) -> None:
        if self.facts.lamp is not None and not hello.powers:
            raise PortError(
                phrase(
                    "The bridge on {name} has firmware {firmware}.{firmware_2}, which cannot set a"
                    " laser's power: flash firmware 1.3, or write pwm = false in outputs.laser.",
                    name=self.name,
                    firmware=hello.firmware[0],
                    firmware_2=hello.firmware[1],
                ),
                alarms.BRIDGE_UNFIT,
            )

    def _require_inputs(self, hello: Hello) -> None:
        """Firmware before 1.4 takes contact on one input for none while others are open."""
        if self.facts.switch_mask.bit_count() > 1 and hello.firmware < (1, 4):
            raise PortError(
                phrase(
                    "The bridge on {name} has firmware {firmware}.{firmware_2}, which knows one"
                    " input for end switches: flash firmware 1.4, or leave out switches.own.",
                    name=self.name,
                    firmware=hello.firmware[0],
                    firmware_2=hello.firmware[1],
                ),
                alarms.BRIDGE_UNFIT,
            )

    def _require_sockets(self, hello: Hello) -> None:
        """Firmware before 1.1 knows a socket of clock and direction by its motor only."""
        facts = self.facts
        in_order = facts.motor_bits == CLOCK_LINES[: len(facts.motor_bits)]
        if facts.kind == c.CARD_CLOCKS and hello.firmware < (1, 1) and not in_order:
            raise PortError(
                phrase(
                    "The bridge on {name} has firmware {firmware}.{firmware_2}, which cannot"
                    " swap motors: give every axis the motor of its place in axes.names, or"
                    " flash firmware 1.1.",
                    name=self.name,
                    firmware=hello.firmware[0],
                    firmware_2=hello.firmware[1],
                ),
                alarms.BRIDGE_UNFIT,
            )
