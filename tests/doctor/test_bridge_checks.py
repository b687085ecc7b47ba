"""Is the bridge there, and the right one: judged on what was seen, and on the simulated chip."""

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from fraese.doctor.board import try_board
from fraese.doctor.bridge import BRIDGE_CHECKS
from fraese.doctor.findings import Finding, Patient, State, ask
from fraese.doctor.opening import Board, Opening, Stage
from fraese.kinds.card import card_of
from fraese.motor.bridge.codec import Hello
from fraese.motor.bridge.trial import Carried
from fraese.motor.bridge.usb import SerialFacts, serial_facts
from fraese.motor.ports.facts import DeviceFacts, lines_of
from rigs.avr.host import SimHost
from tests.bridge.device import image, reason_to_skip
from tests.doctor.ward import by_name, patient, put
from tests.helpers import configured

BRIDGE: dict[str, Any] = {"port": {"kind": "bridge", "device": "/dev/ttyACM0"}}
THERE = DeviceFacts("/dev/ttyACM0", True, True, True, "crw-rw----", "root", "dialout")
HELLO = Hello(
    version=2, session=1, firmware=(1, 0), ring=900, payload_max=80, motors=4, table_max=32,
    window=192, phase_cards=True, clock_cards=True, reset_reason=0, boots=1,
    moving=False, board="uno",
)  # fmt: skip
SOUND = Board(Stage.TRIED, SerialFacts(THERE), 250_000, HELLO, (0.003,) * 50, Carried(200, 0, 0))
needs_chip = pytest.mark.skipif(bool(reason_to_skip()), reason=reason_to_skip())


def checked(tmp_path: Path, error: str = "", **changes: Any) -> dict[str, Finding]:
    opening = Opening(error=error, lines=lines_of(0xF8), board=replace(SOUND, **changes))
    who: Patient = patient(tmp_path, opening=opening, **BRIDGE)
    return by_name(ask(BRIDGE_CHECKS, who))


def states(found: dict[str, Finding], state: State) -> set[str]:
    return {name for name, finding in found.items() if finding.state is state}


def test_a_sound_bridge_is_told_in_figures(tmp_path: Path) -> None:
    found = checked(tmp_path)
    assert states(found, State.OK) == set(found)
    assert found["firmware"].found == (
        "Board uno, firmware 1.0, protocol 2, 250000 baud, 900 bytes of queue."
    )
    assert "200 frames carried, 0 of them sent again" in found["line"].found
    assert "after 3.0 ms (median)" in found["answers"].found


UNTRIED: dict[str, Any] = {"trips_s": (), "carried": None}
ENDS: list[tuple[dict[str, Any], str, set[str]]] = [
    (
        {"stage": Stage.NOWHERE, "serial": None, "hello": None, **UNTRIED},
        "device", {"device", "permission", "claim", "firmware", "card", "line", "answers"},
    ),
    (
        {"stage": Stage.FOUND, "hello": None, **UNTRIED},
        "claim", {"claim", "firmware", "card", "line", "answers"},
    ),
    (
        {"stage": Stage.OPENED, "hello": None, **UNTRIED},
        "firmware", {"firmware", "card", "line", "answers"},
    ),
    ({"stage": Stage.GREETED, **UNTRIED}, "card", {"card", "line", "answers"}),
    ({"stage": Stage.TOLD, **UNTRIED}, "line", {"line", "answers"}),
]  # fmt: skip


@pytest.mark.parametrize(("seen", "where", "bad"), ENDS)
def test_what_failed_says_why_and_what_follows_is_bad(
    tmp_path: Path, seen: dict[str, Any], where: str, bad: set[str]
) -> None:
    found = checked(tmp_path, error="It has gone.", **seen)
    assert states(found, State.BAD) == bad
    assert found[where].found == "It has gone."


def test_who_may_not_use_the_port_is_told_the_group(tmp_path: Path) -> None:
    theirs = SerialFacts(replace(THERE, allowed=False))
    found = checked(
        tmp_path, error="no", stage=Stage.FOUND, serial=theirs, hello=None, **UNTRIED
    )  # fmt: skip
    assert "usermod -aG dialout $USER" in found["permission"].change


def test_a_bad_or_slow_line_is_a_warning(tmp_path: Path) -> None:
    found = checked(tmp_path, carried=Carried(200, 9, 12), trips_s=(0.016,) * 50)
    assert states(found, State.WARN) == {"line", "answers"}
    assert "9 of them sent again; the board found 12 damaged" in found["line"].found
    pausing = checked(tmp_path, trips_s=(*(0.003,) * 49, 0.2))
    assert states(pausing, State.WARN) == {"answers"}


# --- from outside --------------------------------------------------------------------------------


def usb_machine(root: Path, timer: str, control: str) -> Path:
    """A board on an FTDI chip, as /sys shows it."""
    board = root / "sys/devices/pci0/usb1/1-2"
    put(root, "sys/devices/pci0/usb1/1-2/idVendor", "0403\n")
    put(root, "sys/devices/pci0/usb1/1-2/power/control", f"{control}\n")
    put(root, "sys/devices/pci0/usb1/1-2/1-2:1.0/ttyUSB0/latency_timer", f"{timer}\n")
    name = root / "sys/class/tty/ttyUSB0"
    name.mkdir(parents=True)
    (name / "device").symlink_to(board / "1-2:1.0/ttyUSB0")
    put(root, "dev/ttyUSB0")
    return root


def test_what_usb_does_to_answers_is_read_and_told(tmp_path: Path) -> None:
    lazy = serial_facts("/dev/ttyUSB0", usb_machine(tmp_path / "lazy", "16", "auto"))
    assert (lazy.latency_ms, lazy.may_sleep) == (16, True)
    found = checked(tmp_path, serial=lazy)
    assert "for up to 16 ms" in found["latency timer"].found
    assert found["latency timer"].change == f"echo 1 | sudo tee {lazy.latency_file}"
    assert found["usb power"].change == f"echo on | sudo tee {lazy.power_file}"
    prompt = serial_facts("/dev/ttyUSB0", usb_machine(tmp_path / "prompt", "1", "on"))
    found = checked(tmp_path, serial=prompt)
    assert found["latency timer"].state is found["usb power"].state is State.OK


def test_where_nothing_can_be_read_nothing_is_said(tmp_path: Path) -> None:
    facts = serial_facts("/dev/ttyACM0", tmp_path)
    assert (facts.device.present, facts.latency_ms, facts.power_file) == (False, None, None)
    assert checked(tmp_path, serial=facts, stage=Stage.FOUND)["device"].state is State.BAD


# --- really opened -------------------------------------------------------------------------------


def opened(device: str, **sections: Any) -> Opening:
    config = configured(port={"kind": "bridge", "device": device}, **sections)
    return try_board(config, card_of(config))


def test_a_board_that_is_not_there_is_told_in_the_lines_own_words(tmp_path: Path) -> None:
    opening = opened(str(tmp_path / "ttyACM0"))
    assert "does not exist: plug the board in" in opening.error
    assert opening.board is not None
    assert opening.board.stage is Stage.FOUND


@needs_chip
def test_the_chip_is_greeted_told_tried_and_left(tmp_path: Path) -> None:
    with SimHost(image(), tmp_path) as host:
        host.set_status(0xF8)
        opening = opened(host.port)
        assert opening.error == ""
        assert opening.board is not None
        assert opening.board.stage is Stage.TRIED
        assert opening.board.carried is not None
        assert opening.board.carried.frames == 200
        assert opening.lines == lines_of(0xF8)
        # It can be opened again: nothing was left behind.
        assert opened(host.port).error == ""


@needs_chip
def test_the_command_says_it_all_as_one_object(tmp_path: Path) -> None:
    with SimHost(image(), tmp_path) as host:
        host.set_status(0xF8)
        config = tmp_path / "fraese.toml"
        config.write_text(f'[port]\nkind = "bridge"\ndevice = "{host.port}"\n')
        command = [sys.executable, "-m", "fraese", "doctor", "--json", "--no-load"]
        done = subprocess.run(
            [*command, "--seconds", "0.2", "--config", str(config)],
            env={**os.environ, "XDG_STATE_HOME": str(tmp_path)},
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
    said = json.loads(done.stdout.splitlines()[-1])
    checks = {check["name"]: check for check in said["checks"]}
    assert said["port"] == "bridge"
    assert {checks[name]["state"] for name in ("device", "claim", "firmware", "card")} == {"ok"}
    assert checks["inputs"]["state"] == "ok"
    assert checks["firmware"]["found"].startswith("Board uno, firmware ")
    assert "suspend" in checks
    assert done.returncode == 0
