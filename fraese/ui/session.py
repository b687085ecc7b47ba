"""What the app remembers from one day to the next: view, look, file, rate, what was typed, keys.

Rule 1: it is a comfort. What cannot be read, is damaged, or comes from a newer program is
        forgotten, with a word; what cannot be written is let go.
Rule 2: it is written when something has changed, beside everything else, so that also an app that
        is killed has left it. Where two apps run, the last one wins.
Rule 3: a file that was open is opened again, and never started.
"""

import os
import threading
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Annotated, Final, Literal

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    ValidationError,
    ValidatorFunctionWrapHandler,
    WrapValidator,
)

from fraese.errors import ConfigError
from fraese.journal.files import make_folder, open_plain, read_all, replace
from fraese.phrases import phrase
from fraese.ui.heldkeys import Manners

_VERSION: Final = 1
_MOST_BYTES: Final = 1 << 17
_MOST_INPUTS: Final = 200
_MOST_TERMINALS: Final = 50

#: Characters.
_NAME, _PATH, _INPUT = 60, 4096, 500

_Name = Annotated[str, Field(max_length=_NAME)]
_Path = Annotated[str, Field(max_length=_PATH)]
_Rate = Annotated[float, Field(gt=0, allow_inf_nan=False)]
_Input = Annotated[str, Field(max_length=_INPUT)]


#: Of a terminal about which nonsense was kept: nobody has measured it.
_UNMEASURED: Final = Manners()


def _plausible(value: object, read: ValidatorFunctionWrapHandler) -> Manners:
    # One terminal that is to be measured again is no reason to forget all the others, and the file.
    try:
        manners = read(value)
    except ValidationError:
        return _UNMEASURED
    return manners if isinstance(manners, Manners) and manners.are_plausible else _UNMEASURED


_Manners = Annotated[Manners, WrapValidator(_plausible)]


class Session(BaseModel):
    """What is remembered.

    Attributes:
        version: of these words.
        view: the one that was seen.
        theme: the look.
        file: the program that was open; empty: none.
        height_map: to which it was bent; empty: to none.
        folder: where programs were looked for.
        jog_feed_mm_min: how fast jogs go; None: as the configuration says.
        inputs: what was typed last, by the name of the question.
        held_keys: how keys repeat, by the name of the terminal that was measured.
    """

    model_config = ConfigDict(extra="forbid", strict=True)

    version: Literal[1] = _VERSION
    view: _Name = ""
    theme: _Name = ""
    file: _Path = ""
    height_map: _Path = ""
    folder: _Path = ""
    jog_feed_mm_min: _Rate | None = None
    inputs: dict[_Name, _Input] = Field({}, max_length=_MOST_INPUTS)
    held_keys: dict[_Name, _Manners] = Field({}, max_length=_MOST_TERMINALS)


class SessionFile:
    """Where it is kept.

    Args:
        path: of the file; None: nothing is kept.

    Attributes:
        found: what was kept the last time.
        word: why something was forgotten, a sentence; empty: nothing was.
    """

    def __init__(self, path: Path | None) -> None:
        self._path = path
        self._kept = b""
        self._lock = threading.Lock()
        self.word = ""
        self.found = self._read()

    @property
    def is_kept(self) -> bool:
        """There is a place for it."""
        return self._path is not None

    def _read(self) -> Session:
        if self._path is None:
            return Session()
        try:
            fd = open_plain(self._path, os.O_RDONLY)
            if fd is None:
                return Session()
            try:
                content = read_all(fd, _MOST_BYTES)
            finally:
                os.close(fd)
            return self._without_unread(Session.model_validate_json(content))
        except ValidationError as error:
            newer = any(each["loc"] == ("version",) for each in error.errors(include_url=False))
            self.word = (
                phrase("The last session is forgotten: another version of the program kept it.")
                if newer
                else phrase("The last session is forgotten: {path} is damaged.", path=self._path)
            )
        except (OSError, ConfigError):
            self.word = phrase(
                "The last session is forgotten: {path} cannot be read.", path=self._path
            )
        return Session()

    def _without_unread(self, found: Session) -> Session:
        """Without terminals about which nonsense was kept."""
        measured = {name: its for name, its in found.held_keys.items() if its.is_measured}
        if unread := [name for name in found.held_keys if name not in measured]:
            self.word = phrase(
                "How held keys repeat is forgotten for {terminals}: {path} is damaged there.",
                terminals=", ".join(unread),
                path=self._path,
            )
        return found.model_copy(update={"held_keys": measured})

    def keep(self, session: Session) -> None:
        """Write it, if it is another than last time; from any thread."""
        content = session.model_dump_json(indent=1).encode()
        with self._lock, suppress(OSError, ConfigError):
            if self._path is None or content == self._kept:
                return
            make_folder(self._path.parent)
            replace(self._path, content)
            self._kept = content

    def keep_beside(self, session: Session) -> None:
        """The same in a thread of its own: a disk may be slow."""
        content = session.model_copy(deep=True)
        threading.Thread(target=self.keep, args=(content,), name="session", daemon=True).start()


def shortened(inputs: dict[str, str]) -> dict[str, str]:
    """Those that were typed last, as many and as much of them as is kept."""
    latest = list(inputs.items())[-_MOST_INPUTS:]
    fitting = {name: text for name, text in latest if len(name) <= _NAME and len(text) <= _INPUT}
    return {name: text for name, text in fitting.items() if _is_text(text)}


def with_manners(
    measured: Mapping[str, Manners], terminal: str, manners: Manners
) -> dict[str, Manners]:
    """Those of all terminals, with these of one, if they were measured."""
    if not manners.is_measured:
        return dict(measured)
    others = [(name, its) for name, its in measured.items() if name != terminal]
    return {**dict(others[1 - _MOST_TERMINALS :]), terminal: manners}


def keepable(path: Path | None) -> str:
    """A whole path; empty, if it is none or cannot be kept as text."""
    whole = str(path.absolute()) if path is not None else ""
    return whole if len(whole) <= _PATH and _is_text(whole) else ""


def _is_text(text: str) -> bool:
    # Of a name that is no UTF-8 there are pieces that no file of text can hold.
    return not any("\ud800" <= character <= "\udfff" for character in text)
