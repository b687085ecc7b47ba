"""Files of the state folder, opened so that nothing but a file is ever read or written.

Rule 1: a link is never followed, a FIFO or device never opened: whoever planted it gains nothing,
        and nobody waits for it.
Rule 2: a file is the user's alone (0600), a folder that is made too (0700), whatever the umask is.
Rule 3: what replaces a file is complete and on the disk before it has its name.
"""

import os
import stat
from contextlib import suppress
from pathlib import Path
from typing import Final

from fraese.errors import ConfigError
from fraese.phrases import phrase

_MODE: Final = 0o600
_FOLDER_MODE: Final = 0o700
# Where a system has no such flag there is nothing of the kind to fear.
_SAFE: Final = sum(
    getattr(os, name, 0) for name in ("O_NOFOLLOW", "O_NONBLOCK", "O_CLOEXEC", "O_BINARY")
)
#: Put on the disk what was written, and no more than is needed to find it again.
sync: Final = getattr(os, "fdatasync", os.fsync)


def open_plain(path: Path, flags: int) -> int | None:
    """A descriptor of a regular file; None: there is no such file.

    Raises:
        ConfigError: if something else lies there.
        OSError: if it cannot be opened.
    """
    with suppress(FileNotFoundError):
        _require_plain(path, os.lstat(path).st_mode)
        fd = os.open(path, flags | _SAFE)
        try:
            _require_plain(path, os.fstat(fd).st_mode)
        except BaseException:
            os.close(fd)
            raise
        return fd
    return None


def _require_plain(path: Path, mode: int) -> None:
    if stat.S_ISREG(mode):
        return
    what = (
        phrase("a link")
        if stat.S_ISLNK(mode)
        else phrase("a folder")
        if stat.S_ISDIR(mode)
        else phrase("no file")
    )
    raise ConfigError(
        phrase("{path}: is {what}, where the state is kept: remove it.", path=path, what=what)
    )


def make_folder(folder: Path) -> None:
    """The folder, and those above it that are missing.

    Raises:
        OSError: if it cannot be made.
    """
    if folder.is_dir():
        return
    make_folder(folder.parent)
    with suppress(FileExistsError):
        folder.mkdir(_FOLDER_MODE)
        folder.chmod(_FOLDER_MODE)


def create(path: Path) -> int:
    """A descriptor of a new, empty file of the user's own.

    Raises:
        OSError: if it cannot be made, or is there.
    """
    fd = os.open(path, os.O_RDWR | os.O_CREAT | os.O_EXCL | _SAFE, _MODE)
    with suppress(AttributeError):
        os.fchmod(fd, _MODE)
    return fd


def replace(path: Path, content: bytes) -> None:
    """Put a new file in the place of an old one, in one step.

    Only for whoever holds the machine's lock: what a crash left of an earlier try is removed.

    Raises:
        OSError: if it cannot be written; the old one is as it was.
    """
    fresh = path.with_suffix(path.suffix + ".new")
    fresh.unlink(missing_ok=True)
    try:
        fd = create(fresh)
        try:
            write_all(fd, content, 0)
            os.fsync(fd)
        finally:
            os.close(fd)
        fresh.replace(path)
    except BaseException:
        with suppress(OSError):
            fresh.unlink(missing_ok=True)
        raise
    sync_folder(path.parent)


def read_all(fd: int, most: int) -> bytes:
    """What stands in a file, from its beginning.

    Raises:
        OSError: if it cannot be read.
    """
    os.lseek(fd, 0, os.SEEK_SET)
    parts, left = [], most
    while left and (part := os.read(fd, left)):
        parts.append(part)
        left -= len(part)
    return b"".join(parts)


def write_all(fd: int, content: bytes, offset: int) -> None:
    """Write in place, to the last byte.

    Raises:
        OSError: if that cannot be.
    """
    os.lseek(fd, offset, os.SEEK_SET)
    rest = memoryview(content)
    while rest:
        rest = rest[os.write(fd, rest) :]


def sync_folder(folder: Path) -> None:
    """Put a new name on the disk."""
    # Some file systems sync no folder, and need not.
    with suppress(OSError):
        fd = os.open(folder, os.O_RDONLY | getattr(os, "O_DIRECTORY", 0))
        try:
            os.fsync(fd)
        finally:
            os.close(fd)
