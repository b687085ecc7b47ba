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
        return Finding("device", State.BAD, patient.opening.error)
    device = serial.device
    if not device.present:
        return Finding(
            "device",
            State.BAD,
            f"{device.path} does not exist.",
            "Plug the board in, or correct port.device (see fraese ports).",
        )
    who = f"{device.mode}, {device.owner}, group {device.group}"
    return Finding("device", State.OK, f"{device.path} is there ({who}).")


def _permission(patient: Patient) -> Finding:
    serial = _board_of(patient).serial
    if serial is None or not serial.device.present:
        return Finding("permission", State.BAD, "There is no port to use.")
    device = serial.device
    if device.allowed:
        return Finding("permission", State.OK, f"This user may read and write {device.path}.")
    group = device.group if device.group != "root" else "dialout"
    return Finding(
        "permission",
        State.BAD,
        f"This user may not use {device.path}.",
        f"Join its group with sudo usermod -aG {group} $USER and log in again.",
    )


def _claim(patient: Patient) -> Finding:
    if _board_of(patient).stage < Stage.OPENED:
        return Finding("claim", State.BAD, patient.opening.error)
    return Finding("claim", State.OK, "Opened for this program alone and given back.")


def _firmware(patient: Patient) -> Finding:
    board = _board_of(patient)
    if board.stage < Stage.OPENED:
        return Finding("firmware", State.BAD, "The port is not open: nobody could be asked.")
    if board.hello is None:
        return Finding("firmware", State.BAD, patient.opening.error)
    hello = board.hello
    return Finding(
        "firmware",
        State.OK,
        f"Board {hello.board}, firmware {hello.firmware[0]}.{hello.firmware[1]}, protocol"
        f" {hello.version}, {board.baud} baud, {hello.ring} bytes of queue.",
    )


def _card(patient: Patient) -> Finding:
    board, card = _board_of(patient), patient.config.card
    if board.hello is None:
        return Finding("card", State.BAD, "Nobody could be told which card there is.")
    if board.stage < Stage.TOLD:
        return Finding("card", State.BAD, patient.opening.error)
    return Finding(
        "card",
        State.OK,
        f"The board takes the card {card.kind}: it drives {board.hello.motors} motors, with tables"
        f" of up to {board.hello.table_max} entries. Left with motors and outputs off.",
    )


def _line(patient: Patient) -> Finding:
    carried = _board_of(patient).carried
    if carried is None:
        return _untried(patient, "line")
    found = (
        f"{carried.frames} frames carried, {carried.resent} of them sent again; the board found"
        f" {carried.damaged} damaged."
    )
    if carried.resent * 100 <= carried.frames * _RESENT_PERCENT:
        return Finding("line", State.OK, found)
    return Finding(
        "line",
        State.WARN,
        f"{found} No step is lost by that, but the queue is filled more slowly.",
        "Use another cable or plug, without a hub, away from spindle and motor leads.",
    )


def _answers(patient: Patient) -> Finding:
    trips_s = _board_of(patient).trips_s
    if not trips_s:
        return _untried(patient, "answers")
    median_s, slowest_s = statistics.median(trips_s), max(trips_s)
    found = (
        f"Each of {len(trips_s)} questions was answered, after {median_s * 1000:.1f} ms (median),"
        f" {slowest_s * 1000:.1f} ms at most"
    )
    if median_s > _SLOW_S:
        return Finding(
            "answers",
            State.WARN,
            f"{found}: the stop key is that much later.",
            "See latency timer and hubs below; a busy computer answers late, too.",
        )
    if slowest_s > _PAUSE_S:
        return Finding(
            "answers",
            State.WARN,
            f"{found}: this computer pauses.",
            "See what else runs on it.",
        )
    return Finding("answers", State.OK, f"{found}.")


def _untried(patient: Patient, name: str) -> Finding:
    stage = _board_of(patient).stage
    why = patient.opening.error if stage is Stage.TOLD else "The board was not reached."
    return Finding(name, State.BAD, why)


def _latency(patient: Patient) -> Finding:
    serial, name = _board_of(patient).serial, "latency timer"
    if serial is None or serial.latency_ms is None:
        return Finding(name, State.OK, "This port has none that can be read.")
    found = f"The USB chip keeps answers back for up to {serial.latency_ms} ms"
    if serial.latency_ms <= _LATENCY_MS:
        return Finding(name, State.OK, f"{found}.")
    return Finding(
        name,
        State.WARN,
        f"{found}: positions and ends of moves are known that much later.",
        f"echo 1 | sudo tee {serial.latency_file}",
    )


def _usb_power(patient: Patient) -> Finding:
    serial, name = _board_of(patient).serial, "usb power"
    if serial is None or serial.power_file is None:
        return Finding(name, State.OK, "This port is not on USB, as far as can be read.")
    if not serial.may_sleep:
        return Finding(name, State.OK, "USB does not put the board to sleep.")
    return Finding(
        name,
        State.WARN,
        "USB may put the board to sleep when nothing is said for a while (autosuspend).",
        f"echo on | sudo tee {serial.power_file}",
    )


BRIDGE_CHECKS: Final[Sequence[Check]] = (
    _device, _permission, _claim, _firmware, _card, _line, _answers, _latency, _usb_power,
)  # fmt: skip
