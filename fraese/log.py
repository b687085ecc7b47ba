"""The log (SMCMAIN.LOG): one text file, appended, no ring; off at start.

A line is what the original wrote: module, procedure, place in it, extra text; a time in front.
It rides on Python's logging, so that a test or another program can listen in its own way.

Rule 1: functions that matter log their entry with parameters and their exit with results: use
        ``logged``. It costs one comparison while the log is off.
Rule 2: never from inside a loop over ticks, moves or polls; a long job must not drown in its log.
Rule 3: what is logged is one plain line: nothing foreign in it breaks it or commands a terminal.
"""

import contextlib
import errno
import functools
import logging
import os
import stat
from collections.abc import Callable
from io import TextIOWrapper
from pathlib import Path
from typing import Any, Final, ParamSpec, TypeVar

from fraese.errors import ConfigError
from fraese.phrases import phrase, reason
from fraese.plaintext import plain

P = ParamSpec("P")
R = TypeVar("R")

_LOGGER: Final = logging.getLogger("fraese")
_LOGGER.setLevel(logging.CRITICAL + 1)
_LOGGER.addHandler(logging.NullHandler())
_MAX_VALUE_CHARACTERS: Final = 200


def write(module: str, procedure: str, place: str, text: str = "") -> None:
    """One line: module, procedure, place in the procedure, extra text."""
    if _LOGGER.isEnabledFor(logging.INFO):
        _LOGGER.info("%-11s %-22s %-7s %s", module.upper(), procedure, place, plain(text))


def logged(function: Callable[P, R]) -> Callable[P, R]:
    """Log entry with parameters and exit with the result, or with the error."""
    module = function.__module__.rpartition(".")[2]
    name = function.__name__

    @functools.wraps(function)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> R:
        if not _LOGGER.isEnabledFor(logging.INFO):
            return function(*args, **kwargs)
        write(module, name, "entry", _shown(args[1:], kwargs))
        try:
            result = function(*args, **kwargs)
        except Exception as error:
            write(module, name, "error", _short(error))
            raise
        write(module, name, "exit", "" if result is None else _short(result))
        return result

    return wrapper


def _short(value: object) -> str:
    text = str(value) if isinstance(value, Exception) else repr(value)
    cut = text if len(text) <= _MAX_VALUE_CHARACTERS else text[:_MAX_VALUE_CHARACTERS] + "..."
    return cut.replace("\n", " ")


def _shown(args: tuple[Any, ...], kwargs: dict[str, Any]) -> str:
    named = [f"{key}={_short(value)}" for key, value in kwargs.items()]
    return ", ".join([_short(arg) for arg in args] + named)


class _Handler(logging.FileHandler):
    """A file that cannot be written any more (a full disk) does not disturb the machine."""

    def _open(self) -> TextIOWrapper:
        """A file and nothing else: a pipe or a device would be waited for.

        Raises:
            OSError: if it cannot be opened, or is none.
        """
        flags = os.O_WRONLY | os.O_APPEND | os.O_CREAT | getattr(os, "O_NONBLOCK", 0)
        try:
            fd = os.open(self.baseFilename, flags | getattr(os, "O_NOCTTY", 0), 0o600)
        except OSError as error:
            # So is a pipe opened that nobody reads.
            raise _no_file() if error.errno == errno.ENXIO else error from error
        if not stat.S_ISREG(os.fstat(fd).st_mode):
            os.close(fd)
            raise _no_file()
        return open(fd, "a", encoding="utf-8", errors="backslashreplace")

    def handleError(self, record: logging.LogRecord) -> None:  # noqa: N802 (logging's name)
        pass


def _no_file() -> OSError:
    return OSError(errno.EINVAL, phrase("a log is a file, and this is something else"))


class LogFile:
    """The file, switched on and off at run time.

    Args:
        path: where it is appended; folders are made when it is first switched on.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._handler: logging.FileHandler | None = None

    @property
    def is_on(self) -> bool:
        """Whether lines are being written."""
        return self._handler is not None

    def switch(self, on: bool) -> None:
        """On or off; what was written stays.

        Raises:
            ConfigError: if the file cannot be written.
        """
        if on == self.is_on:
            return
        if self._handler is not None:
            write("log", "switch", "exit", "log off")
            _LOGGER.removeHandler(self._handler)
            with contextlib.suppress(OSError):
                self._handler.close()
            self._handler = None
            _LOGGER.setLevel(logging.CRITICAL + 1)
            return
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            handler = _Handler(self.path, encoding="utf-8")
        except OSError as error:
            raise ConfigError(
                phrase(
                    "{path}: the log cannot be written: {reason}.",
                    path=self.path,
                    reason=reason(error),
                )
            ) from error
        handler.setFormatter(
            logging.Formatter("%(asctime)s.%(msecs)03d %(message)s", "%Y-%m-%d %H:%M:%S")
        )
        _LOGGER.addHandler(handler)
        _LOGGER.setLevel(logging.INFO)
        self._handler = handler
        write("log", "switch", "entry", "log on")
