"""The firmware put on a board: found, written by avrdude, tried out.

    port free? --> somebody asked --> which boot loader answers? --> avrdude --> ``bridge test``

Rule 1: nothing is written before somebody has said yes: whatever was on the board is gone then.
Rule 2: what avrdude says is shown where it failed, and only what tells why.
"""

import json
import shlex
import shutil
import subprocess
import sys
from collections.abc import Sequence
from typing import Annotated, Final

import typer

from fraese.cli.bridgeplace import Place
from fraese.cli.bridgetrial import tried
from fraese.cli.output import note, say
from fraese.errors import Cancelled, PortError, UsageError
from fraese.motor.bridge.boards import BOARDS, IMAGE_BAUD, Try, boards_of, tries_of
from fraese.motor.bridge.bootloader import answers
from fraese.motor.bridge.line import serial_ports
from fraese.phrases import joined, phrase

BoardOption = Annotated[
    str | None,
    typer.Option("--board", metavar="|".join(BOARDS), help="Which board it is; else found out."),
]
DryRunOption = Annotated[
    bool, typer.Option("--dry-run", help="Only say what would be called; nothing is written.")
]

HALF_WRITTEN: Final = phrase(
    "Cancelled; if the board was being written it has no whole firmware now: flash it again."
)
_AVRDUDE: Final = "avrdude"
#: Where it comes from, by the beginning of ``sys.platform``.
_INSTALL: Final = {
    "linux": "sudo apt install avrdude",
    "darwin": "brew install avrdude",
    "win": "winget install AVRDudes.AVRDUDE",
}
#: So long one attempt may take: an image of 30 KB at 57600 baud is written and read in 15 s.
_PATIENCE_S: Final = 120
#: So many of its lines are shown.
_MOST_LINES: Final = 3
#: Of lines that a port may not have; it goes on all the same.
_NOISE: Final = "ioctl"


def flashed(place: Place, board: str | None, *, yes: bool, dry_run: bool, as_json: bool) -> int:
    """Put the firmware on the board that is there, and try it out; the exit code.

    Args:
        place: where it is.
        board: which it is; None: is found out.
        yes: nobody is asked.
        dry_run: only say what would be called.
        as_json: for programs.

    Raises:
        UsageError: there is no such board, or no avrdude; nothing was written.
        PortError: the port cannot be had, or no boot loader has answered.
        Cancelled: the person does not want it.
    """
    tries = tries_of((_known(board),) if board else _seen(place.device))
    if dry_run:
        commands = [each.command(place.device) for each in tries]
        for line in [json.dumps(commands)] if as_json else map(shlex.join, commands):
            say(line)
        return 0
    program = shutil.which(_AVRDUDE)
    if program is None:
        raise UsageError(_how_to_install())
    # What is in the way is said in our own words; closed, so that avrdude can have it.
    place.line().close()
    _ask(tries, place.device, yes=yes)
    done = _write(_answering(tries, place.device), place.device, program)
    note(phrase("{title}: written and read back.", title=done.board.title))
    if place.baud != IMAGE_BAUD:
        note(
            phrase(
                "The image speaks at {image_baud} baud, the configuration says {baud}: set"
                " port.baud = {image_baud}.",
                image_baud=IMAGE_BAUD,
                baud=place.baud,
            )
        )
    return tried(place._replace(baud=IMAGE_BAUD), 0, None, as_json=as_json)


def _known(board: str) -> str:
    if board not in BOARDS:
        raise UsageError(
            phrase("--board {board}: is none of {boards}.", board=board, boards=", ".join(BOARDS))
        )
    return board


def _seen(device: str) -> tuple[str, ...]:
    """What the USB device behind this port may be."""
    for port in serial_ports():
        if port.device == device:
            return boards_of(port.vid, port.pid)
    return boards_of(None, None)


def _how_to_install() -> str:
    how = next((how for name, how in _INSTALL.items() if sys.platform.startswith(name)), "")
    return (
        phrase("avrdude, which writes boards, is not installed: {how}", how=how)
        if how
        else phrase("avrdude, which writes boards, is not installed.")
    )


def _ask(tries: Sequence[Try], device: str, *, yes: bool) -> None:
    titles = dict.fromkeys(each.board.title for each in tries)
    either = joined(phrase(" or "), titles)
    question = phrase(
        "Write the firmware to {device} ({board})? What is on the board is replaced.",
        device=device,
        board=either,
    )
    if yes:
        return
    if not sys.stdin.isatty():
        raise UsageError(phrase("It asks before a board is written; without a terminal add --yes."))
    note(joined("", (question, " [y/N] ")), end="")
    if sys.stdin.readline().strip().lower() not in ("y", "yes", "j", "ja"):
        raise Cancelled(phrase("Nothing was written."))


def _answering(tries: Sequence[Try], device: str) -> Sequence[Try]:
    """Of several, those that answer; of one, it.

    Raises:
        PortError: none does.
    """
    if len(tries) == 1:
        return tries
    for each in tries:
        if answers(device, each):
            return (each,)
    raise PortError(
        phrase(
            "No boot loader on {device} answers: is it an Uno, a Nano or a Mega? One that is not"
            " reset by its port is written with --board, while its button is pressed.",
            device=device,
        )
    )


def _write(tries: Sequence[Try], device: str, program: str) -> Try:
    """Write it by the first boot loader that answers.

    Raises:
        PortError: none does; with the last words of avrdude.
    """
    said = ""
    for each in tries:
        note(
            phrase(
                "{title}, boot loader at {baud} baud ...", title=each.board.title, baud=each.baud
            )
        )
        ended = _called(each.command(device, program))
        if ended is None:
            return each
        said = ended
    raise PortError(
        phrase(
            "No boot loader on {device} took the firmware: is it one of these boards, and"
            " its cable whole? avrdude said: {said}",
            device=device,
            said=said,
        )
    )


def _called(command: Sequence[str]) -> str | None:
    """Call avrdude; None: all went well; else what it said last."""
    try:
        done = subprocess.run(
            command,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=_PATIENCE_S,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return phrase("nothing, for {patience_s} s", patience_s=_PATIENCE_S)
    except OSError as error:
        return str(error)
    if done.returncode == 0:
        return None
    said = " / ".join(_telling(done.stderr.decode("utf-8", "replace")))
    return said or phrase("nothing (exit code {code})", code=done.returncode)


def _telling(said: str) -> list[str]:
    """Of all that avrdude said: what went wrong; where it does not say so, its last words."""
    lines = [line.strip() for line in said.replace("\r", "\n").splitlines() if line.strip()]
    errors = [line for line in lines if "error" in line.lower() and _NOISE not in line]
    return list(dict.fromkeys(errors))[:_MOST_LINES] or lines[-_MOST_LINES:]
