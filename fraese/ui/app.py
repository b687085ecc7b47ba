"""The app's commands: what each key of the table does."""

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any, ClassVar

from textual import events, work
from textual.actions import SkipAction
from textual.app import SystemCommand
from textual.binding import Binding, BindingType
from textual.driver import Driver
from textual.screen import Screen

from fraese.control.controller import Controller
from fraese.control.state import Status
from fraese.errors import FraeseError
from fraese.ui.jogging import Jog, Jogger
from fraese.ui.keys import COMMANDS, FIRST_WIDTH, STOP_KEYS, WIDTHS, RepeatRule
from fraese.ui.machine_app import BUSY, MachineApp
from fraese.ui.machine_screen import PICTURES
from fraese.ui.messages import Noted, Refused
from fraese.ui.programs import OpenProgram, Program, in_words
from fraese.ui.stopkey import EarlyStop, Heard
from fraese.ui.themes import DARK, LIGHT


def _bindings() -> list[BindingType]:
    return [
        Binding(
            command.keys,
            command.action,
            command.footer or command.title,
            show=bool(command.footer),
            key_display=command.shown,
            priority=command.priority,
        )
        for command in COMMANDS
    ]


class FraeseApp(MachineApp):
    """The terminal app.

    Args:
        controller: owned by the app's worker thread until the app has ended, and closed then.
        open_program: reads a program file; called in a thread of its own.
        notes: sentences to show at the start.
        before_motion: called in the machine's thread before every command that moves; what it
            raises is shown, and nothing moves.
        program: file to open at the start.
        machine_name: which machine is driven, such as "simulated mill"; shown in the title.
        hand: presses (True) or lets go of (False) an end switch of a simulated machine, by name.
    """

    TITLE = "fraese"
    CSS_PATH = "fraese.tcss"
    BINDINGS: ClassVar[list[BindingType]] = _bindings()
    COMMAND_PALETTE_BINDING = "ctrl+p"

    def __init__(
        self,
        controller: Controller,
        *,
        open_program: OpenProgram,
        notes: Sequence[str] = (),
        before_motion: Callable[[], object] | None = None,
        program: Path | None = None,
        machine_name: str = "",
        hand: Callable[[str, bool], None] | None = None,
    ) -> None:
        self._early_stop = EarlyStop(STOP_KEYS, self._brake_or_stop)
        self._heard: Heard | None = None
        super().__init__(controller, notes, before_motion, machine_name)
        self._open_program = open_program
        self._hand = hand
        self._jogger = Jogger(controller, self._worker)
        self._repeats = RepeatRule()
        self._width = FIRST_WIDTH
        self._program: Program | None = None
        self._program_path = program
        self._last_go_to: object = None

    def on_mount(self) -> None:
        """What was given at the start."""
        self._machine.show_width(self._width, 1)
        if self._program_path is not None:
            self._load(self._program_path)

    # --- keys ----------------------------------------------------------------------------------

    def get_driver_class(self) -> type[Driver]:
        """The terminal's, which tells of stop keys first."""
        return self._early_stop.driver(super().get_driver_class())

    async def on_event(self, event: events.Event) -> None:
        """Let the repeat rule see every key before anything happens."""
        if isinstance(event, events.Key) and not event.is_forwarded:
            self._repeats.press(event.key)
            self._heard = self._early_stop.of(event)
        await super().on_event(event)
        self._heard = None

    def forget_repeats(self) -> None:
        """Something other than a key was used."""
        self._repeats.press("")

    def get_system_commands(self, screen: Screen[Any]) -> Iterable[SystemCommand]:
        """The palette: every command of the table."""
        for command in COMMANDS:
            yield SystemCommand(
                command.title,
                f"Key {command.shown}. {command.help}",
                self._from_palette(command.action),
            )

    def _from_palette(self, action: str) -> Callable[[], object]:
        async def run() -> None:
            await self.run_action(action)

        return run

    # --- commands ------------------------------------------------------------------------------

    def action_stop_machine(self) -> None:
        """Brake; the second time while it moves, stop. At standstill the key is free."""
        if self._heard is None:
            moving = self._brake_or_stop()
        else:
            # Also what was pressed before it and has begun only now.
            moving = self._heard.moving or self._moving
            self._worker.cancel()
            self._jogger.forget()
        if not moving:
            raise SkipAction
        self._machine.show(self._state, True)

    def _brake_or_stop(self) -> bool:
        """Do it; whether the machine moved. From any thread."""
        moving = self._moving
        if self._controller.cancelling:
            self._worker.stop()
        else:
            self._worker.cancel()
        self._jogger.forget()
        return moving

    def action_hold(self) -> None:
        """Feed hold, or go on."""
        if self._controller.holding:
            self._controller.resume()
        elif self._moving:
            self._controller.hold()

    def action_override(self, by_percent: int) -> None:
        """Feed override up or down, or (0) as programmed."""
        percent = round(self._controller.override * 100) + by_percent if by_percent else 100
        self._controller.set_override(min(max(percent, 10), 200) / 100)

    def action_acknowledge(self) -> None:
        """Take note of an error."""
        if self._state.status is Status.ERROR:
            self.order(self._controller.acknowledge, moves=False)

    def action_jog(self, axis: str, sign: int) -> None:
        """One press."""
        width_mm = WIDTHS[self._width].mm
        factor = self._repeats.factor
        self._machine.show_width(self._width, factor)
        single = Jog(axis, steps=sign * factor)
        jog = single if width_mm is None else Jog(axis, mm=sign * width_mm)
        if not self._jogger.press(jog, self._before_motion):
            self._refuse(BUSY)

    def action_width(self, by: int) -> None:
        """The next width, or the one before."""
        self.action_set_width((self._width + by) % len(WIDTHS))

    def action_set_width(self, index: int) -> None:
        """This width."""
        self._width = index
        self._machine.show_width(index, 1)

    def action_go_to(self) -> None:
        """Ask where to."""
        from fraese.ui.dialogs import GoTo, GoToDialog

        last = self._last_go_to if isinstance(self._last_go_to, GoTo) else None
        self.push_screen(GoToDialog(self._axes, last), self._go_to)

    def _go_to(self, wanted: object) -> None:
        from fraese.ui.dialogs import From, GoTo

        if not isinstance(wanted, GoTo):
            return
        self._last_go_to = wanted
        self.order(
            lambda: self._controller.move_to(
                wanted.target.targets_mm,
                relative=wanted.counted_from is From.HERE,
                machine_coordinates=wanted.counted_from is From.MACHINE,
                feed_mm_min=wanted.target.feed_mm_min,
            )
        )

    def action_reference(self) -> None:
        """Ask which axes."""
        from fraese.ui.dialogs import ReferenceDialog

        self.push_screen(ReferenceDialog(self._axes), self._reference)

    def _reference(self, wanted: object) -> None:
        from fraese.ui.dialogs import Reference

        if isinstance(wanted, Reference):
            self.order(lambda: self._controller.home(wanted.axes, measure=wanted.measure))

    def action_zero(self, axis: str) -> None:
        """Work zero here, of one axis or (empty) all."""
        axes = (axis,) if axis else self._axes

        def zero() -> None:
            before = self._controller.state()
            self._controller.set_zero(axes)
            was = " ".join(
                f"{name.upper()} {before.work_mm[before.axes.index(name)]:.3f}" for name in axes
            )
            self.post_message(Noted(f"Work zero set here; this point was {was} mm before."))

        self.order(zero, moves=False)

    def action_ignore(self) -> None:
        """Contacts stop the motors, or do not."""
        ignore = not self._state.switch_ignored
        self.order(lambda: self._controller.ignore_switches(ignore), moves=False)

    def action_log(self) -> None:
        """Log on or off, also while a job runs."""
        try:
            self._controller.switch_log(not self._controller.state().log_on)
        except FraeseError as error:
            self._refuse(str(error))
            return
        self._offer()
        log = self._controller.log
        if log is not None:
            self._note(f"The log is {'on' if log.is_on else 'off'}: {log.path}")

    def action_switch_test(self) -> None:
        """Each switch by hand."""
        from fraese.ui.switch_screen import SwitchScreen

        if self._moving:
            self._refuse(BUSY)
            return
        self.push_screen(SwitchScreen(self._axes, self._hand))
        self.call_after_refresh(self._show_on_top, self._state)

    def action_help(self) -> None:
        """The keys."""
        from fraese.ui.help_screen import HelpScreen

        self.push_screen(HelpScreen())

    def action_picture(self) -> None:
        """The next of the three."""
        at = PICTURES.index(self._machine.picture)
        self._machine.show_picture(PICTURES[(at + 1) % len(PICTURES)])

    def action_scroll_path(self, pages: int) -> None:
        """Look elsewhere in the program."""
        self._machine.scroll_path(pages)

    def action_theme(self) -> None:
        """Dark or light."""
        self.theme = LIGHT.name if self.theme == DARK.name else DARK.name

    def action_leave(self) -> None:
        """Leave, unless the machine runs."""
        if self._moving:
            self._refuse("The machine runs: stop it first (Esc), or leave at once with Ctrl+Q.")
        else:
            self.exit()

    async def action_quit(self) -> None:
        """Brake and leave."""
        self._worker.cancel()
        self.exit()

    # --- programs ------------------------------------------------------------------------------

    def action_open(self) -> None:
        """Ask for a file."""
        from fraese.ui.dialogs import OpenDialog

        path = self._program_path
        folder = path.parent if path is not None and path.parent.is_dir() else Path.cwd()
        self.push_screen(OpenDialog(folder, str(path or "")), self._chosen)

    def _chosen(self, path: Path | None) -> None:
        if path is not None:
            self._load(path)

    @work(thread=True, exclusive=True, group="program")
    def _load(self, path: Path) -> None:
        """Read the file, which may be long, beside everything else."""
        try:
            program = self._open_program(path)
        except FraeseError as error:
            self.post_message(Refused(str(error)))
        except Exception as error:  # a reader's mistake must not end the control of a machine
            self.post_message(Refused(f"{path}: the reader failed, {error!r}; nothing is loaded."))
        else:
            self.call_from_thread(self._loaded, path, program)

    def _loaded(self, path: Path, program: Program) -> None:
        if self._moving:
            self._refuse(BUSY)
            return
        self._program_path, self._program = path, program
        self._machine.show_program(program.name, program.lines)
        self._machine.show_picture("path")

        def check() -> None:
            facts = program.check(self._controller)
            for warning in facts.warnings:
                self.post_message(Noted(warning, warning=True))
            self.post_message(Noted(f"{program.name}: {in_words(facts)}. Start it with s."))

        self.order(check, moves=False)

    def action_start(self) -> None:
        """Run the program."""
        program = self._program
        if program is None:
            self._refuse("No program is loaded: open one with o.")
            return
        self.order(lambda: program.start(self._controller))
