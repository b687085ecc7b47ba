"""The bench: the data byte as lamps, coils, rotors and the lines as they are played."""

from typing import Final

from textual.app import ComposeResult
from textual.containers import VerticalScroll

from fraese.control.benchfacts import BenchFacts
from fraese.control.controller import Controller
from fraese.control.slowmotion import turn_slowly
from fraese.control.state import MachineState
from fraese.phrases import spoken
from fraese.ui.keyrows import Area
from fraese.ui.views.view import Desk, View
from fraese.ui.widgets import lamps
from fraese.ui.widgets.fact import Paragraph

#: Slow motion, steps/s.
RATES_HZ: Final = (1, 2, 5, 10, 25, 50, 100, 200)
_FIRST_RATE: Final = 3
_TURN_STEPS: Final = 8
#: From so many rows on there is room for dials; a picture of the lines takes so many at most.
_DIAL_ROWS, _WAVE_ROWS = 26, 20


class BenchView(View):
    """Shows what is on the wires; turns a motor step by step."""

    AREA = Area.BENCH
    NAME = "bench"

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk)
        self._at = 0
        self._rate = _FIRST_RATE
        self._pressed = ""
        self._listens = self._wants_lines = False
        self._text = Paragraph(id="bench-text")

    def inner(self) -> ComposeResult:
        """One text."""
        with VerticalScroll(id="bench", can_focus=False):
            yield self._text

    # --- coming and going ------------------------------------------------------------------------

    def on_screen_resume(self) -> None:
        """Somebody looks: the lines are listened to."""
        self._wants_lines = True
        self._listen()
        self.show_again()

    def on_screen_suspend(self) -> None:
        """Nobody looks."""
        self._wants_lines = False
        self._listen()

    def _listen(self) -> None:
        """As soon as the machine stands; before that the lines are not touched."""
        bench, wanted = self.desk.bench, self._wants_lines
        if bench is None or self._listens is wanted or self.desk.link.moving:
            return

        def listen(controller: Controller) -> None:
            bench.listen(wanted)
            self._listens = wanted

        self.desk.link.order_of(listen)

    # --- what is shown ---------------------------------------------------------------------------

    def show_inner(self, state: MachineState) -> None:
        """All of it; only while it is seen."""
        bench = self.desk.bench
        if bench is None:
            self._text.show(spoken("This machine is not open: there is nothing to be seen here."))
            return
        self._listen()
        facts = bench.look()
        width, rows = (
            max(60, self.query_one("#bench").size.width),
            self.query_one("#bench").size.height,
        )
        lines = [*self._lines(facts, state, width), ""]
        if rows >= _DIAL_ROWS:
            lines += [*lamps.dials(facts.motors), ""]
        if self._listens:
            # A line that says what was lost may come between.
            room = self.query_one("#bench").size.height - len(lines) - 1
            lines += lamps.waves(bench.lines(), width, min(_WAVE_ROWS, max(2, room)))
        elif not bench.is_simulated:
            lines.append(
                spoken("The lines of metal are written down with --trace, see fraese trace.")
            )
        self._text.show("\n".join(lines))

    def _lines(self, facts: BenchFacts, state: MachineState, width: int) -> list[str]:
        motors, rate = facts.motors, RATES_HZ[self._rate]
        entries = len(facts.table)
        inputs = lamps.pins(spoken("inputs "), state.inputs)
        outputs = lamps.pins(spoken("control"), facts.outputs)
        return [
            lamps.lamps(facts),
            inputs + "   " + outputs,
            *(
                lamps.motor_line(motor, entries, n == self._at, width)
                for n, motor in enumerate(motors)
            ),
            lamps.table_line(facts, motors[self._at]),
            spoken("slow motion {rate} steps/s", rate=rate)
            + (spoken("   {pressed} pressed", pressed=self._pressed) * bool(self._pressed)),
        ]

    # --- motors ----------------------------------------------------------------------------------

    @property
    def _axis(self) -> str:
        return self.desk.link.shape.axes[self._at].name

    def action_motor(self, by: int) -> None:
        """Another one."""
        self._at = (self._at + by) % len(self.desk.link.shape.axes)
        self.show_again()

    def action_rate(self, by: int) -> None:
        """Slow motion, slower or faster."""
        self._rate = min(max(self._rate + by, 0), len(RATES_HZ) - 1)
        self.show_again()

    def action_turn(self, steps: int) -> None:
        """So many steps."""
        axis, rate_hz = self._axis, RATES_HZ[self._rate]
        self.expect(
            self.desk.link.order_of(lambda machine: turn_slowly(machine, axis, steps, rate_hz))
        )

    def action_turns(self, sign: int) -> None:
        """An electrical turn."""
        facts = self.desk.bench.look() if self.desk.bench else None
        length = len(facts.table) if facts and facts.table else _TURN_STEPS
        self.action_turn(sign * length)

    def action_table(self) -> None:
        """The next phase table."""
        bench = self.desk.bench
        if bench is None or not bench.tables:
            self.refuse(
                spoken(
                    "Another phase table is chosen by card.table in the configuration, and"
                    " counts from the next start."
                )
            )
            return
        at = bench.tables.index(bench.look().table_name)
        name = bench.tables[(at + 1) % len(bench.tables)]

        def choose(controller: Controller) -> None:
            bench.choose_table(name)
            self.app.call_later(
                self.note,
                spoken("The motors are driven by {name} until the program ends.", name=name),
            )

        self.expect(self.desk.link.order_of(choose))

    # --- hands at the simulated mill -------------------------------------------------------------

    def action_press(self) -> None:
        """The lower end switch, or take the hand off."""
        hand = self.desk.hand
        if hand is None:
            self.refuse(
                spoken("Press the switch at the machine: only a simulated mill has no fingers.")
            )
            return
        if self._pressed:
            hand(self._pressed, False)
            self._pressed = ""
        else:
            self._pressed = self._axis + "min"
            hand(self._pressed, True)
        self.show_again()

    def action_block(self) -> None:
        """Hold the carriage, or let it go."""
        bench = self.desk.bench
        if bench is None or not bench.is_simulated:
            self.refuse(spoken("Only the carriage of a simulated mill can be held from here."))
            return
        held = bench.look().motors[self._at].is_blocked
        bench.block(self._axis, not held)
        self.show_again()
