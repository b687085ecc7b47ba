"""Is the bridge there, ours, and the right one? A table of checks.

Rule 1: it is opened once, before the checks (``board.py``). A check only judges.
Rule 2: what could not be looked at, since something before it failed, says so and is bad.
Rule 3: the microcontroller keeps time by itself, and its queue lasts for a quarter of a second: a
        slow or bad line is a warning, not an end.
"""

import statistics
from collections.abc import Sequence
from typing import Final

from fraese.doctor.findings import Check, Finding, Patient, State
from fraese.doctor.opening import Board, Stage
from fraese.phrases import phrase

#: An answer takes 3 ms at 250,000 baud; a brake is confirmed no sooner.
_SLOW_S: Final = 0.01
#: A pause of the computer longer than this is felt by no motor, but says what it is like.
_PAUSE_S: Final = 0.1
#: So many frames in a hundred may be sent again before something is wrong with cable or plug.
_RESENT_PERCENT: Final = 1
_LATENCY_MS: Final = 2


def _board_of(patient: Patient) -> Board:
    return patient.opening.board or Board()


def _device(patient: Patient) -> Finding:
    serial = _board_of(patient).serial
    if serial is None:
        return Finding(phrase("device"), State.BAD, patient.opening.error)
    device = serial.device
    if not device.present:
        return Finding(
            phrase("device"),
            State.BAD,
            phrase("{path} does not exist.", path=device.path),
            phrase("Plug the board in, or correct port.device (see fraese ports)."),
        )
    who = f"{device.mode}, {device.owner}, group {device.group}"
    return Finding(
        phrase("device"), State.OK, phrase("{path} is there ({who}).", path=device.path, who=who)
    )


def _permission(patient: Patient) -> Finding:
    serial = _board_of(patient).serial
    if serial is None or not serial.device.present:
        return Finding(phrase("permission"), State.BAD, phrase("There is no port to use."))
    device = serial.device
    if device.allowed:
        return Finding(
            phrase("permission"),
            State.OK,
            phrase("This user may read and write {path}.", path=device.path),
        )
    group = device.group if device.group != "root" else "dialout"
    return Finding(
        phrase("permission"),
        State.BAD,
        phrase("This user may not use {path}.", path=device.path),
        phrase("Join its group with sudo usermod -aG {group} $USER and log in again.", group=group),
    )


def _claim(patient: Patient) -> Finding:
    if _board_of(patient).stage < Stage.OPENED:
        return Finding(phrase("claim"), State.BAD, patient.opening.error)
    return Finding(
        phrase("claim"), State.OK, phrase("Opened for this program alone and given back.")
    )


def _firmware(patient: Patient) -> Finding:
    board = _board_of(patient)
    if board.stage < Stage.OPENED:
        return Finding(
            phrase("firmware"), State.BAD, phrase("The port is not open: nobody could be asked.")
        )
    if board.hello is None:
        return Finding(phrase("firmware"), State.BAD, patient.opening.error)
    hello = board.hello
    return Finding(
        phrase("firmware"),
        State.OK,
        phrase(
            "Board {board}, firmware {firmware}.{firmware_2}, protocol {version}, {baud}"
            " baud, {ring} bytes of queue.",
            board=hello.board,
            firmware=hello.firmware[0],
            firmware_2=hello.firmware[1],
            version=hello.version,
            baud=board.baud,
            ring=hello.ring,
        ),
    )


def _card(patient: Patient) -> Finding:
    board, card = _board_of(patient), patient.config.card
    if board.hello is None:
        return Finding(
            phrase("card"), State.BAD, phrase("Nobody could be told which card there is.")
        )
    if board.stage < Stage.TOLD:
        return Finding(phrase("card"), State.BAD, patient.opening.error)
    return Finding(
        phrase("card"),
        State.OK,
        phrase(
            "The board takes the card {kind}: it drives {motors} motors, with tables of up"
            " to {table_max} entries. Left with motors and outputs off.",
            kind=card.kind,
            motors=board.hello.motors,
            table_max=board.hello.table_max,
        ),
    )


def _line(patient: Patient) -> Finding:
    carried = _board_of(patient).carried
    if carried is None:
        return _untried(patient, "line")
    found = phrase(
        "{frames} frames carried, {resent} of them sent again; the board found {damaged} damaged.",
        frames=carried.frames,
        resent=carried.resent,
        damaged=carried.damaged,
    )
    if carried.resent * 100 <= carried.frames * _RESENT_PERCENT:
        return Finding(phrase("line"), State.OK, found)
    return Finding(
        phrase("line"),
        State.WARN,
        phrase(
            "{found} No step is lost by that, but the queue is filled more slowly.", found=found
        ),
        phrase("Use another cable or plug, without a hub, away from spindle and motor leads."),
    )


def _answers(patient: Patient) -> Finding:
    trips_s = _board_of(patient).trips_s
    if not trips_s:
        return _untried(patient, "answers")
    median_s, slowest_s = statistics.median(trips_s), max(trips_s)
    found = phrase(
        "Each of {count} questions was answered, after {median_s:.1f} ms (median),"
        " {slowest_s:.1f} ms at most",
        count=len(trips_s),
        median_s=median_s * 1000,
        slowest_s=slowest_s * 1000,
    )
    if median_s > _SLOW_S:
        return Finding(
            phrase("answers"),
            State.WARN,
            phrase("{found}: the stop key is that much later.", found=found),
            phrase("See latency timer and hubs below; a busy computer answers late, too."),
        )
    if slowest_s > _PAUSE_S:
        return Finding(
            phrase("answers"),
            State.WARN,
            phrase("{found}: this computer pauses.", found=found),
            phrase("See what else runs on it."),
        )
    return Finding(phrase("answers"), State.OK, f"{found}.")


def _untried(patient: Patient, name: str) -> Finding:
    stage = _board_of(patient).stage
    why = patient.opening.error if stage is Stage.TOLD else phrase("The board was not reached.")
    return Finding(name, State.BAD, why)


def _latency(patient: Patient) -> Finding:
    serial, name = _board_of(patient).serial, phrase("latency timer")
    if serial is None or serial.latency_ms is None:
        return Finding(name, State.OK, phrase("This port has none that can be read."))
    found = phrase(
        "The USB chip keeps answers back for up to {latency_ms} ms", latency_ms=serial.latency_ms
    )
    if serial.latency_ms <= _LATENCY_MS:
        return Finding(name, State.OK, f"{found}.")
    return Finding(
        name,
        State.WARN,
        phrase("{found}: positions and ends of moves are known that much later.", found=found),
        phrase("echo 1 | sudo tee {latency_file}", latency_file=serial.latency_file),
    )


def _usb_power(patient: Patient) -> Finding:
    serial, name = _board_of(patient).serial, phrase("usb power")
    if serial is None or serial.power_file is None:
        return Finding(name, State.OK, phrase("This port is not on USB, as far as can be read."))
    if not serial.may_sleep:
        return Finding(name, State.OK, phrase("USB does not put the board to sleep."))
    return Finding(
        name,
        State.WARN,
        phrase("USB may put the board to sleep when nothing is said for a while (autosuspend)."),
        phrase("echo on | sudo tee {power_file}", power_file=serial.power_file),
    )


BRIDGE_CHECKS: Final[Sequence[Check]] = (
    _device, _permission, _claim, _firmware, _card, _line, _answers, _latency, _usb_power,
)  # fmt: skip
