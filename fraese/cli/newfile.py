"""Files that commands make: whole or not at all, and never over others."""

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from fraese.errors import OutputError, UsageError
from fraese.phrases import phrase, reason


def check_new(path: Path, *, force: bool) -> None:
    """See whether a file may be made.

    Args:
        path: of it.
        force: also over one that is there.

    Raises:
        UsageError: if it may not.
    """
    try:
        if path.exists() and not path.is_file():
            raise UsageError(phrase("{path} is no file that could be written.", path=path))
        if path.exists() and not force:
            raise UsageError(
                phrase("{path} is there; it is overwritten with --force only.", path=path)
            )
        if not path.resolve().parent.is_dir():
            raise UsageError(phrase("{path}: there is no such folder.", path=path))
    except OSError as error:
        raise UsageError(
            phrase("{path} cannot be written: {reason}.", path=path, reason=reason(error))
        ) from error
    except ValueError as error:
        raise UsageError(phrase("{file} is no name of a file.", file=repr(str(path)))) from error


@contextlib.contextmanager
def new_file(path: Path) -> Iterator[BinaryIO]:
    """A file to write to, which is there when it is whole.

    Raises:
        OutputError: if it cannot be written, also half-way.
    """
    # Through a link to what it names.
    whole = path.resolve()
    part = whole.with_name(f"{whole.name}.{os.getpid()}.part")
    try:
        with part.open("xb") as file:
            yield file
        part.replace(whole)
    except OSError as error:
        raise OutputError(
            phrase("{path} cannot be written: {reason}.", path=path, reason=reason(error))
        ) from error
    finally:
        with contextlib.suppress(OSError):
            part.unlink()
