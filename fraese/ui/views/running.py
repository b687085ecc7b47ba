"""What views do with programs: open, look through, start; all beside everything else.

    open ---> read ---> asked in the machine's thread ---> looked through ---> said
    start --> asked in the machine's thread ---> looked through ---> one dialog ---> started there

Rule 1: nothing starts that was not looked through as the machine stands at that moment.
Rule 2: a look-through can be given up at any moment, and never holds up the app.
Rule 3: what is said is said in the view that is seen by then.
"""

import threading
from abc import abstractmethod
from collections.abc import Callable
from pathlib import Path
from typing import Any

from fraese.control.controller import Controller
from fraese.errors import FraeseError, StateError
from fraese.phrases import spoken
from fraese.ui.dialogs.byhand import LAST_MAP
from fraese.ui.dialogs.open import MapDialog, OpenDialog
from fraese.ui.dialogs.start import Decision, StartDialog, WayDialog, What
from fraese.ui.keyrows.everywhere import STOP
from fraese.ui.programs import Facts, Look, Program, in_words
from fraese.ui.views.afterfaults import GoesOn
from fraese.ui.views.view import BUSY
from fraese.ui.widgets.scene import Scene


class RunsPrograms(GoesOn):
    """Opens programs, and starts them."""

    @abstractmethod
    def show_program(self, program: Program) -> None:
        """This one is loaded now."""

    @abstractmethod
    def show_line(self, line: int) -> None:
        """Look at this line of it."""

    # --- opening ---------------------------------------------------------------------------------

    def action_open(self) -> None:
        """Ask for a file."""
        programs = self.desk.programs
        if self.desk.link.moving:
            self.seen.refuse(BUSY)
            return
        dialog = OpenDialog(
            self.desk.keys, programs.folder, str(programs.path or ""), programs.recent.paths()
        )
        self.app.push_screen(dialog, self._chosen)

    def _chosen(self, path: Path | None) -> None:
        if path is not None:
            self.load(path)

    def load(self, path: Path) -> None:
        """Read the file, which may be long, beside everything else."""
        programs = self.desk.programs
        look = programs.begin()
        self.seen.say(
            spoken("{name} is being read; {said} ends that.", name=path.name, said=STOP.said)
        )

        def read() -> None:
            program = programs.read(path)
            programs.recent.add(path)
            self._bend_again(path, program)
            self.call_later(self._loaded, path, program, look)

        self._aside(look, read)

    def _bend_again(self, path: Path, program: Program) -> None:
        """What was read anew is bent to the height map that it had; where that is gone, a word."""
        heights = self.desk.programs.maps.of(path)
        if heights is None or program.map_words:
            return
        try:
            program.bend_to(heights)
        except FraeseError as error:
            said = spoken(
                "{name} is not bent to its height map any more: {why}",
                name=path.name,
                why=str(error),
            )
            self.call_later(self.seen.note, said, warning=True)

    def _aside(self, look: Look, action: Callable[[], None]) -> None:
        """Do this in a thread of its own, for which nobody waits; say what it is refused for."""

        def go() -> None:
            try:
                action()
            except FraeseError as error:
                self.call_later(self._failed, look, str(error))
            except Exception as error:  # of a reader, which must not end the control of a machine
                self.call_later(
                    self._failed,
                    look,
                    spoken("Reading the program failed: {error}.", error=repr(error)),
                )

        look.busy = True
        threading.Thread(target=go, name="program", daemon=True).start()

    def _failed(self, look: Look, sentence: str) -> None:
        if self.desk.programs.ended(look):
            self.seen.refuse(sentence)

    def _loaded(self, path: Path, program: Program, look: Look) -> None:
        if look.given_up:
            return
        if self.desk.link.moving:
            self.desk.programs.ended(look)
            self.seen.refuse(BUSY)
            return
        self.put(path, program)
        self._see_through(program, look)

    def _see_through(self, program: Program, look: Look) -> None:
        """Look it through as the machine stands, if that is not known."""

        def ask(controller: Controller) -> None:
            question = program.question(controller)
            if question is None:
                self.call_later(self._is_known, program, look)
            else:
                self.call_later(self._look, program, question, look)

        self._order(look, ask)

    def put(self, path: Path, program: Program) -> None:
        """This one is loaded now, and shown."""
        self.desk.programs.put(path, program)
        self.show_program(program)

    def _order(self, look: Look, order: Callable[[Controller], None]) -> None:
        taken = self.desk.link.order_of(order)
        if not taken:
            self.desk.programs.ended(look)
        self.seen.expect(taken)

    def action_height_map(self) -> None:
        """Ask to which height map the program is bent."""
        desk = self.desk
        program = desk.programs.program
        if desk.link.moving:
            self.seen.refuse(BUSY)
        elif program is None:
            said = desk.keys.said("open")
            self.seen.refuse(spoken("No program is loaded: open one with {said}.", said=said))
        else:
            offered = desk.inputs.get(LAST_MAP, "")
            dialog = MapDialog(desk.keys, desk.programs.folder, offered)
            self.app.push_screen(dialog, lambda path: self._map_chosen(program, path))

    def _map_chosen(self, program: Program, path: Path | None) -> None:
        if path is None:
            return
        desk = self.desk
        look, chosen = desk.programs.begin(), path if path.name else None
        if chosen is not None:
            desk.inputs[LAST_MAP] = str(chosen)

        def read() -> None:
            program.bend_to(chosen)
            desk.programs.maps.remember(desk.programs.path, chosen)
            self.call_later(self._see_through, program, look)

        self._aside(look, read)

    # --- looking through -------------------------------------------------------------------------

    def _look(self, program: Program, question: Any, look: Look, *, start: bool = False) -> None:
        """Look it through beside everything else; then say so, or ask whether to start it."""
        if look.given_up:
            return
        self.seen.say(
            spoken(
                "{name} is being looked through; {said} ends that.",
                name=program.name,
                said=STOP.said,
            )
        )

        def through() -> None:
            try:
                facts = program.look(question)
            except FraeseError as error:
                self.call_later(self._refused, program, look, str(error), start)
            else:
                self.call_later(self._looked, program, facts, look, start)

        self._aside(look, through)

    def _refused(self, program: Program, look: Look, sentence: str, start: bool) -> None:
        if self.desk.programs.ended(look):
            self.seen.refuse(sentence)
            if start and program.facts is not None:
                self._ask_to_start(program)

    def _looked(self, program: Program, facts: Facts, look: Look, start: bool) -> None:
        if not self.desk.programs.ended(look):
            return
        for warning in facts.warnings:
            self.seen.note(warning, warning=True)
        self.seen.note(
            spoken(
                "{name}: {in_words}. Start it with {said}.",
                name=program.name,
                in_words=in_words(facts),
                said=self.desk.keys.said("start"),
            )
        )
        if start:
            self._ask_to_start(program)

    def _is_known(self, program: Program, look: Look) -> None:
        if self.desk.programs.ended(look):
            facts = program.facts
            words = f": {in_words(facts)}" if facts is not None else ""
            self.seen.note(
                spoken(
                    "{name}{words}. Start it with {said}.",
                    name=program.name,
                    words=words,
                    said=self.desk.keys.said("start"),
                )
            )

    # --- starting --------------------------------------------------------------------------------

    def action_start(self) -> None:
        """Show what is known of the program; it is looked through first if that is not of now."""
        programs = self.desk.programs
        program, look = programs.program, programs.look
        if self.desk.link.moving:
            self.seen.refuse(BUSY)
            return
        if look is not None and look.busy:
            self.seen.refuse(
                spoken("Wait for the look-through, or end it with {said}.", said=STOP.said)
            )
            return
        if program is None:
            self.seen.refuse(
                spoken(
                    "No program is loaded: open one with {said}.", said=self.desk.keys.said("open")
                )
            )
            return
        look = programs.begin()

        def ask(controller: Controller) -> None:
            question = program.question(controller)
            if question is None:
                self.call_later(self._known_at_start, program, look)
            else:
                self.call_later(self._look, program, question, look, start=True)

        self._order(look, ask)

    def _known_at_start(self, program: Program, look: Look) -> None:
        if self.desk.programs.ended(look):
            self._ask_to_start(program)

    def _ask_to_start(self, program: Program) -> None:
        """The one dialog."""
        state, facts = self.desk.link.state(), program.facts
        if facts is None:
            return
        # Below a dialog nothing is drawn on: it is not to look as if it were still looked through.
        self.seen.show_again()
        scene = Scene.of(state, facts.outline)
        dialog = StartDialog(
            self.desk.keys,
            program,
            self.desk.link.shape,
            state,
            scene,
            program.news(),
            self.desk.link.switches_tried,
        )
        self.app.push_screen(dialog, lambda decision: self._decided_start(program, decision))

    def _decided_start(self, program: Program, decision: Decision | None) -> None:
        if decision is None:
            return
        if decision.what is What.LOOK_AT:
            seen = self.seen
            (seen if isinstance(seen, RunsPrograms) else self).show_line(decision.line)
        elif decision.what is What.FRAME:
            self.seen.expect(self.desk.link.order_of(program.drive_frame))
        elif decision.line > 1:
            self._show_way(program, decision.line)
        else:
            self._begin(program, 0)

    def _begin(self, program: Program, from_line: int) -> None:
        """Start it, if the machine still stands as it was looked through for."""

        def begin(controller: Controller) -> None:
            if program.question(controller) is not None:
                raise StateError(
                    spoken(
                        "The machine has changed while {name} was looked through: start it"
                        " again with {said}; nothing has moved.",
                        name=program.name,
                        said=self.desk.keys.said("start"),
                    )
                )
            if from_line:
                program.start(controller, from_line=from_line)
            else:
                program.start(controller)

        self.seen.expect(self.desk.link.order_of(begin))

    def _show_way(self, program: Program, from_line: int) -> None:
        """What a start in the middle will do, before it is done."""
        look = self.desk.programs.begin()

        def ask(controller: Controller) -> None:
            stands = program.stands(controller)
            self.call_later(read, stands)

        def read(stands: Any) -> None:
            def way() -> None:
                lines = program.way_lines(stands, from_line, lambda: look.given_up)
                self.call_later(shown, list(lines))

            self._aside(look, way)

        def shown(lines: list[str]) -> None:
            if self.desk.programs.ended(look):
                self.app.push_screen(WayDialog(self.desk.keys, lines), decided)

        def decided(yes: bool | None) -> None:
            if yes:
                self._begin(program, from_line)

        self._order(look, ask)
