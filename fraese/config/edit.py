"""Keys of the configuration file changed, everything else in it left as it was written.

Rule 1: only the named keys change: comments, order and layout stay.
Rule 2: what would be refused at the next start is refused now, and nothing is written.
Rule 3: the file is replaced whole, or not at all; a link to it stays a link. One that is
        write-protected is not replaced either, though a folder would allow it.
"""

import os
import tempfile
from collections.abc import Mapping, Sequence
from contextlib import suppress
from decimal import Decimal
from pathlib import Path
from typing import Any, Final

import platformdirs
import tomlkit
from tomlkit.exceptions import TOMLKitError

from fraese.config.file import FILE_NAME, check_text, find_file, is_plain_file
from fraese.errors import ConfigError
from fraese.phrases import phrase, reason

#: What a key may become.
Value = bool | int | float | Decimal | str | tuple[Any, ...]
#: The same, or None: the key is taken out, and its default holds.
Change = Value | None
_NEW_FILE_MODE: Final = 0o644
_ANY_MAY_WRITE: Final = 0o222


def file_to_write(named: Path | None = None) -> Path:
    """The file that counts, or the one that would be made.

    Raises:
        ConfigError: if a file was named and is not there.
    """
    return find_file(named) or Path(platformdirs.user_config_dir("fraese")) / FILE_NAME


class AsTyped(str):
    """A value that is written as it is, in the language of the file."""

    __slots__ = ()


def set_keys(path: Path, values: Mapping[str, Change], known: str | None = None) -> None:
    """Change keys of a configuration file; it is made if it is not there.

    Args:
        path: the file.
        values: what to write, by the dotted name of its key (``axes.x.pitch_mm``).
        known: what the file held when somebody looked at it; None: nobody has.

    Raises:
        ConfigError: one sentence, if the file cannot be read or written, holds something else by
            now, or would be refused with these values; it is unchanged then.
    """
    before = text_of(path)
    if known is not None and before != known:
        gone = not os.path.lexists(path)
        raise ConfigError(
            phrase("{path}: is not there any more; nothing was written.", path=path)
            if gone
            else phrase(
                "{path}: was changed by somebody else meanwhile; nothing was written.", path=path
            )
        )
    text = changed(path, before, values)
    check_text(text, str(path))
    _replace(path, text)


class FileWriter:
    """Writes the file that counts.

    Args:
        named: by the user; None: the one that is found.
    """

    def __init__(self, named: Path | None = None) -> None:
        self._named = named

    @property
    def path(self) -> str:
        """Of the file, or of the one that would be made."""
        return str(file_to_write(self._named))

    def write(self, values: Mapping[str, Change]) -> None:
        """See ``set_keys``."""
        set_keys(Path(self.path), values)


def as_toml(value: Value) -> str:
    """A value as it stands in the file."""
    if isinstance(value, tuple):
        return "[" + ", ".join(as_toml(each) for each in value) + "]"
    if isinstance(value, AsTyped):
        return str(value)
    if isinstance(value, bool | str):
        return tomlkit.item(value).as_string()
    if isinstance(value, float) and value.is_integer():
        return str(int(value))
    return f"{value:f}" if isinstance(value, Decimal) else str(value)


def text_of(path: Path) -> str:
    """What the file holds; nothing, if it is not there.

    Raises:
        ConfigError: if it cannot be read.
    """
    try:
        return path.read_bytes().decode("utf-8") if is_plain_file(path) else ""
    except OSError as error:
        raise ConfigError(
            phrase("{path}: cannot be read: {reason}.", path=path, reason=reason(error))
        ) from error
    except UnicodeDecodeError as error:
        raise ConfigError(phrase("{path}: is not a text file in UTF-8.", path=path)) from error


def changed(path: Path, text: str, values: Mapping[str, Change]) -> str:
    """What a file holds, with these keys changed.

    Args:
        path: of the file, for complaints.
        text: what it holds.
        values: see ``set_keys``.

    Raises:
        ConfigError: if it is no configuration, or a key is no place in it.
    """
    try:
        document = tomlkit.parse(text)
        for key, value in values.items():
            *tables, name = key.split(".")
            if value is None:
                _take_out(document, tables, name)
            else:
                _place(document, tables)[name] = tomlkit.value(as_toml(value))
        return tomlkit.dumps(document)
    except (TOMLKitError, TypeError, AttributeError, ValueError, IndexError) as error:
        raise ConfigError(
            phrase("{path}: cannot be changed: {error}.", path=path, error=error)
        ) from error


def _place(document: Any, tables: Sequence[str]) -> Any:
    """The table with this name; it is made if it is not there."""
    place = document
    for table in tables:
        if isinstance(place, list):
            place = place[int(table)]
            continue
        if table not in place:
            # Its own heading comes with its first key, that of its parent never.
            place[table] = tomlkit.table(is_super_table=table is not tables[-1])
        place = place[table]
    return place


def _take_out(document: Any, tables: Sequence[str], name: str) -> None:
    place = document
    for table in tables:
        place = place[int(table)] if isinstance(place, list) else place.get(table)
        if place is None:
            return
    if name in place:
        del place[name]


def _replace(path: Path, text: str) -> None:
    """Beside it, then in its place: a power cut leaves the old file or the new one."""
    target = path.resolve()
    beside = ""
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        mode = target.stat().st_mode & 0o777 if target.exists() else _NEW_FILE_MODE
        if not mode & _ANY_MAY_WRITE:
            raise ConfigError(
                phrase("{path}: is write-protected (chmod u+w lets it be changed).", path=path)
            )
        descriptor, beside = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name}.")
        with open(descriptor, "w", encoding="utf-8", newline="") as file:
            os.chmod(beside, mode)
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        os.replace(beside, target)
    except OSError as error:
        with suppress(OSError):
            os.unlink(beside)
        raise ConfigError(
            phrase("{path}: cannot be written: {reason}.", path=path, reason=reason(error))
        ) from error
