"""The bridge, really opened once: asked who it is, told its card, tried, and left with motors off.

    look from outside --> open --> greet --> card --> questions, frames --> close

Rule 1: nothing moves: no block is sent.
Rule 2: how far it came is kept. What fails is told in the bridge's own sentence.
"""

from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from fraese.blocks import Q8
from fraese.config import Config
from fraese.control.endswitches import contact_bits
from fraese.doctor.opening import Board, Opening, Stage
from fraese.errors import PortError
from fraese.kinds.card import card_kind
from fraese.motor.bridge.connection import Connection
from fraese.motor.bridge.fromcard import card_facts
from fraese.motor.bridge.greeting import PATIENCE_S
from fraese.motor.bridge.line import OpenLine, SerialLine, only_candidate, serial_ports
from fraese.motor.bridge.session import greeting
from fraese.motor.bridge.stepwise import finish
from fraese.motor.bridge.trial import carry, round_trips_s
from fraese.motor.bridge.usb import serial_facts
from fraese.motor.clock import MonotonicClock
from fraese.motor.ports.facts import lines_of
from fraese.motor.seams import Card, SwitchMode
from fraese.motor.switches import SwitchInput


def try_board(config: Config, card: Card, root: Path = Path("/")) -> Opening:
    """Open the bridge as the machine would do it, and close it again.

    Args:
        config: of the machine.
        card: what hangs on the bridge.
        root: where the file system begins, for what is looked at from outside.
    """
    trial = _Trial(config, card, root)
    error = ""
    try:
        trial.run()
    except PortError as failed:
        error = str(failed)
    return replace(trial.opening, error=error)


class _Trial:
    """One try; ``opening`` tells how far it came."""

    def __init__(self, config: Config, card: Card, root: Path) -> None:
        self._config = config
        self._card = card
        self._root = root
        self._board = Board(baud=config.port.baud)
        self.opening = Opening(board=self._board)

    def run(self) -> None:
        """All of it.

        Raises:
            PortError: as soon as something does not work.
        """
        device = self._config.port.device or only_candidate(serial_ports())
        self._came(Stage.FOUND, serial=serial_facts(device, self._root))
        line = SerialLine(device, self._config.port.baud)
        self._came(Stage.OPENED)
        clock, baud = MonotonicClock(), self._config.port.baud
        session = finish(greeting(line, clock, device, baud))
        try:
            self._came(Stage.GREETED, hello=session.hello)
            connection = self._connection(lambda: line, clock, device)
            told = connection.telling(session, self._card.phases(), SwitchMode.STOP, Q8)
            finish(told)
            self._came(Stage.TOLD)
            trips_s, carried = tuple(round_trips_s(session)), carry(session)
            self._came(Stage.TRIED, trips_s=trips_s, carried=carried)
            self.opening = replace(self.opening, lines=lines_of(session.ask().inputs))
        finally:
            # What went wrong before says more than a farewell that goes wrong, too.
            with suppress(PortError):
                session.close()

    def _connection(self, open_line: OpenLine, clock: MonotonicClock, device: str) -> Connection:
        switches = self._config.switches
        facts = card_facts(
            card_kind(self._config).facts(self._card, self._config.card.kind),
            SwitchInput(*contact_bits(self._config), switches.readings),
            settle_cycles=0,
            safe_outputs=self._config.outputs.off_at_rest,
            silence_ms=round(self._config.realtime.silence_of_bridge_s * 1000),
        )
        return Connection(open_line, clock, facts, device, self._config.port.baud, PATIENCE_S)

    def _came(self, stage: Stage, **seen: object) -> None:
        self._board = replace(self._board, stage=stage, **seen)  # type: ignore[arg-type]
        self.opening = replace(self.opening, board=self._board)
