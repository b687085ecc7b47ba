"""The program: its path, its lines in step with it, its progress; for whichever view shows it.

Rule 1: what is shown is what is loaded, whoever loaded it.
Rule 2: the path is drawn on at most every ``_FRAME_S``; what comes in between is seen by the timer.
"""

import math
import time
from typing import Any, Final

from textual.app import ComposeResult
from textual.containers import Container

from fraese.control.state import MachineState
from fraese.phrases import spoken
from fraese.ui.programs import Facts, Program, ProgramDesk
from fraese.ui.widgets.path import PathView
from fraese.ui.widgets.progress import ProgressPanel, runs_program
from fraese.ui.widgets.scene import spot, travel_box
from fraese.ui.widgets.status import clock_words
from fraese.ui.widgets.toolpath import Toolpath

#: Between two pictures of the path.
_FRAME_S: Final = 0.1
#: How often it is looked at what goes on beside the machine.
_LOOK_S: Final = 0.25


class ProgramPane(Container):
    """Path, lines and progress.

    Args:
        programs: what is loaded.
        state: how the machine stands.
        open_key: opens a program.
    """

    def __init__(
        self, programs: ProgramDesk, state: MachineState, open_key: str, **options: Any
    ) -> None:
        options.setdefault("id", "program-pane")
        super().__init__(**options)
        self._programs = programs
        self._state = state
        self._loaded: Program | None = None
        self._drawn_s = -math.inf
        self.toolpath = Toolpath()
        self.listing = PathView(open_key)
        self.progress = ProgressPanel()

    def compose(self) -> ComposeResult:
        """Path beside or over the lines, the progress below."""
        with Container(id="program-body"):
            yield self.toolpath
            yield self.listing
        yield self.progress

    def on_mount(self) -> None:
        """From time to time somebody looks."""
        self.set_interval(_LOOK_S, self._look)

    def on_show(self) -> None:
        """What was hidden has not been kept up to date."""
        self._look()

    def show(self, state: MachineState) -> None:
        """Draw what changed."""
        self._state = state
        if not self.is_mounted or not self.display:
            return
        job = state.job
        running = runs_program(state) and job is not None
        self._follow_program()
        self.listing.mark(job.line if running and job else 0)
        self._show_progress(state)
        now_s = time.monotonic()
        if now_s - self._drawn_s >= _FRAME_S:
            self._drawn_s = now_s
            self._draw(state, job.move if running and job else 0, running)

    def _look(self) -> None:
        if self.is_on_screen:
            self._drawn_s = -math.inf
            self.show(self._state)

    @property
    def is_on_screen(self) -> bool:
        """Somebody sees it."""
        return self.is_mounted and self.display and self.screen.is_active

    def _follow_program(self) -> None:
        program = self._programs.program
        if program is not self._loaded:
            self._loaded = program
            self.toolpath.forget()
            if program is not None:
                self.listing.load(program.lines, program.parts)
        if program is not None:
            stage, facts = program.stage, program.facts
            found = stage.outline if stage is not None and stage.outline is not None else None
            if stage is None and facts is not None:
                found = facts.outline
            if found is not None:
                self.toolpath.show_way(found)

    def _draw(self, state: MachineState, move: int, running: bool) -> None:
        box = travel_box(state)
        if box is None:
            self.toolpath.hide_box()
        else:
            self.toolpath.show_box(*box)
        tool, zero = spot(state, state.position_mm), spot(state, state.offset_mm)
        self.toolpath.show_place(tool, zero, move, running=running)

    def _show_progress(self, state: MachineState) -> None:
        program, job = self._loaded, state.job
        if runs_program(state) and job is not None:
            self.progress.show_job(state, job)
        elif program is None:
            look = self._programs.look
            name = spoken("reading …") if look is not None and look.busy else spoken("no program")
            self.progress.show_idle(name, "", state)
        elif program.stage is not None:
            self.progress.show_check(program.name, program.stage.lines, len(program.lines))
        else:
            self.progress.show_idle(program.name, _found(program.facts), state)


def _found(facts: Facts | None) -> str:
    """What the last look-through found, in a few words."""
    if facts is None:
        return spoken("not checked")
    wrong = len(facts.errors) + len(facts.outside)
    if wrong:
        if wrong == 1:
            return spoken("refused: 1 line is wrong")
        return spoken("refused: {wrong} lines are wrong", wrong=wrong)
    return spoken(
        "{clock_words}   {length_mm:.0f} mm   ok",
        clock_words=clock_words(facts.duration_s),
        length_mm=facts.length_mm,
    )
