"""The machine does not fall asleep while there is a driver: an inhibitor held by a child process.

    fraese --pipe--> systemd-inhibit --> sh: says that it has begun, waits for the end of the pipe

Rule 1: after a suspend nobody knows what is on the pins, and the motors have moved or not. So it is
        held from the opening of the port to its end, not only while motors turn.
Rule 2: it ends with the pipe: also when this process is killed, nothing is left over.
Rule 3: where it cannot be had, that is a fact to be told, not an error.
"""

import contextlib
import os
import select
import shutil
import subprocess
from collections.abc import Mapping
from typing import Final

from fraese.phrases import phrase, reason

_COMMAND: Final = "systemd-inhibit"
_HELD: Final = b"held"
#: Says that the inhibitor is held, and keeps it until its input ends.
_KEEP: Final = ("sh", "-c", "echo held; exec cat >/dev/null")
#: Whoever answers later than this does not count, s.
_PATIENCE_S: Final = 2.0


class Awake:
    """Keeps the machine from sleeping, if that can be had, until it is let go.

    Args:
        environment: where to look for the command; None: this process's.

    Attributes:
        note: what came of it, a sentence without its full stop.
    """

    def __init__(self, environment: Mapping[str, str] | None = None) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self.note = self._hold(os.environ if environment is None else environment)

    @property
    def held(self) -> bool:
        """The machine will not fall asleep."""
        return self._process is not None

    def let_go(self) -> None:
        """It may sleep again. Safe to call twice."""
        process, self._process = self._process, None
        if process is not None:
            _end(process)

    def _hold(self, environment: Mapping[str, str]) -> str:
        found = shutil.which(_COMMAND, path=environment.get("PATH"))
        if found is None:
            return phrase("the machine may fall asleep: there is no {command}", command=_COMMAND)
        try:
            process = _start(found, environment)
        except OSError as error:
            return phrase(
                "the machine may fall asleep: {command}: {reason}",
                command=_COMMAND,
                reason=reason(error),
            )
        said = _said(process)
        if said.startswith(_HELD):
            self._process = process
            return phrase("the machine does not fall asleep")
        _end(process)
        why = said.decode("utf-8", "replace").strip().splitlines() or ["no answer"]
        return phrase("the machine may fall asleep: {command}: {why}", command=_COMMAND, why=why[0])


def _start(found: str, environment: Mapping[str, str]) -> "subprocess.Popen[bytes]":
    return subprocess.Popen(
        [
            found, "--what=sleep:idle", "--who=fraese", "--mode=block",
            "--why=The mill is connected", "--", *_KEEP,
        ],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        start_new_session=True,
        env=environment,
    )  # fmt: skip


def _said(process: "subprocess.Popen[bytes]") -> bytes:
    """Its first words, if they come in time."""
    assert process.stdout is not None
    ready, _, _ = select.select([process.stdout], [], [], _PATIENCE_S)
    return os.read(process.stdout.fileno(), 4096) if ready else b""


def _end(process: "subprocess.Popen[bytes]") -> None:
    assert process.stdin is not None
    assert process.stdout is not None
    with contextlib.suppress(OSError):
        process.stdin.close()
    process.stdout.close()
    try:
        process.wait(_PATIENCE_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
