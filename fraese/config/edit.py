"""Keys of the configuration file changed, everything else in it left as it was written.

Rule 1: only the named keys change: comments, order and layout stay.
Rule 2: what would be refused at the next start is refused now, and nothing is written.
Rule 3: the file is replaced whole, or not at all; a link to it stays a link.
"""

import os
import tempfile
from collections.abc import Mapping
from contextlib import suppress
from decimal import Decimal
from pathlib import Path
from typing import Any, Final

import platformdirs
import tomlkit
from tomlkit.exceptions import TOMLKitError

from fraese.config.file import FILE_NAME, check_text, find_file
from fraese.errors import ConfigError
from fraese.phrases import phrase, reason

#: What a key may become.
Value = bool | int | float | Decimal | str | tuple[Any, ...]
_NEW_FILE_MODE: Final = 0o644


def file_to_write(named: Path | None = None) -> Path:
    """The file that counts, or the one that would be made.

    Raises:
        ConfigError: if a file was named and is not there.
    """
    return find_file(named) or Path(platformdirs.user_config_dir("fraese")) / FILE_NAME


def set_keys(path: Path, values: Mapping[str, Value]) -> None:
    """Change keys of a configuration file; it is made if it is not there.

    Args:
        path: the file.
        values: what to write, by the dotted name of its key (``axes.x.pitch_mm``).

    Raises:
        ConfigError: one sentence, if the file cannot be read or written, or would be refused with
            these values; it is unchanged then.
    """
    text = _changed(path, _text(path), values)
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

    def write(self, values: Mapping[str, Value]) -> None:
        """See ``set_keys``."""
        set_keys(Path(self.path), values)


def as_toml(value: Value) -> str:
    """A value as it stands in the file."""
    if isinstance(value, tuple):
        return "[" + ", ".join(as_toml(each) for each in value) + "]"
    if isinstance(value, bool | str):
        return tomlkit.item(value).as_string()
    if isinstance(value, float) and value.is_integer():
        return str(int(value))
    return f"{value:f}" if isinstance(value, Decimal) else str(value)


def _text(path: Path) -> str:
    try:
        return path.read_bytes().decode("utf-8") if os.path.lexists(path) else ""
    except OSError as error:
        raise ConfigError(
            phrase("{path}: cannot be read: {reason}.", path=path, reason=reason(error))
        ) from error
    except UnicodeDecodeError as error:
        raise ConfigError(phrase("{path}: is not a text file in UTF-8.", path=path)) from error


def _changed(path: Path, text: str, values: Mapping[str, Value]) -> str:
    try:
        document = tomlkit.parse(text)
        for key, value in values.items():
            *tables, name = key.split(".")
            place: Any = document
            for table in tables:
                if table not in place:
                    # Its own heading comes with its first key, that of its parent never.
                    place[table] = tomlkit.table(is_super_table=table is not tables[-1])
                place = place[table]
            place[name] = tomlkit.value(as_toml(value))
        return tomlkit.dumps(document)
    except (TOMLKitError, TypeError, AttributeError) as error:
        raise ConfigError(
            phrase("{path}: cannot be changed: {error}.", path=path, error=error)
        ) from error


def _replace(path: Path, text: str) -> None:
    """Beside it, then in its place: a power cut leaves the old file or the new one."""
    target = path.resolve()
    beside = ""
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        mode = target.stat().st_mode & 0o777 if target.exists() else _NEW_FILE_MODE
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
