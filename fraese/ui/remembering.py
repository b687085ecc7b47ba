"""The app begins as it was left: view, look, file, what was typed, how its keys repeat."""

import contextlib
from pathlib import Path
from typing import Final

from fraese.errors import FraeseError
from fraese.ui.eventlog import EventLog, Kind
from fraese.ui.heldkeys import HeldKeys
from fraese.ui.machinelink import MachineLink
from fraese.ui.measuring import terminal_name
from fraese.ui.programs import ProgramDesk
from fraese.ui.session import Session, SessionFile, keepable, shortened, with_manners
from fraese.ui.viewed import ViewedApp

#: What is remembered is written so often, if it has changed.
_KEEP_EVERY_S: Final = 2.0


class RememberingApp(ViewedApp):
    """An app that goes on where it was left; its file is opened again, and not started."""

    link: MachineLink
    _session: SessionFile
    _programs: ProgramDesk
    _events: EventLog
    _inputs: dict[str, str]
    _strokes: HeldKeys

    def remember_files(self) -> None:
        """As the last time: keys, folder, the file that was open; before a view looks for it."""
        found = self._session.found
        if self._session.word:
            self._events.add(self._session.word, Kind.WARNING)
        self._strokes.manners = found.held_keys.get(terminal_name(), self._strokes.manners)
        if found.jog_feed_mm_min is not None:
            try:
                self.link.jog_rate.choose(found.jog_feed_mm_min)
            except FraeseError as error:
                self._events.add(str(error), Kind.WARNING)
        if found.folder:
            self._programs.last_folder = Path(found.folder)
        if found.file and self._programs.path is None:
            self._open_again(Path(found.file))
        if found.file and found.height_map:
            self._programs.maps.remember(Path(found.file), Path(found.height_map))

    def remember_picture(self) -> None:
        """As the last time: look and view; from now on it is kept what changes."""
        found = self._session.found
        if found.theme in self.available_themes:
            self.theme = found.theme
        if found.view:
            self.call_later(self.action_show_view, found.view)
        if self._session.is_kept:
            self.set_interval(_KEEP_EVERY_S, lambda: self._session.keep_beside(self.session()))

    def _open_again(self, path: Path) -> None:
        with contextlib.suppress(OSError):
            if path.is_file():
                self._programs.path = path
                return
        self._events.add(f"{path.name} was open the last time, and is not there any more.")

    def session(self) -> Session:
        """What there is to remember."""
        programs = self._programs
        loaded = programs.path if programs.program is not None else None
        return Session(
            view=self.current_mode,
            theme=self.theme,
            file=keepable(loaded),
            height_map=keepable(programs.maps.of(loaded)),
            folder=keepable(programs.folder),
            jog_feed_mm_min=self.link.jog_rate.chosen,
            inputs=shortened(self._inputs),
            held_keys=with_manners(
                self._session.found.held_keys, terminal_name(), self._strokes.manners
            ),
        )
