"""Is the port there, and ours: judged on machines made for it, and on the fake port."""

import errno
import json
import re
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from fraese.doctor.findings import Finding, Patient, State, ask
from fraese.doctor.opening import Opening
from fraese.doctor.parallel import try_port
from fraese.doctor.port import PORT_CHECKS
from fraese.errors import PortError
from fraese.motor.cards.control import OutputPin
from fraese.motor.cards.smc1500 import SmcCard
from fraese.motor.ports.facts import DeviceFacts, output_pins
from fraese.motor.ports.null import NullPort
from fraese.peers import PORTS
from tests.doctor.ward import DEVPORT, by_name, patient, put, sound_machine
from tests.rigs.lpt.fakeport import AT_REST, CONTACT, FakePort, missing

needs_fake_port = pytest.mark.skipif(bool(missing()), reason=missing())


def with_devices(who: Patient) -> Patient:
    """The plain files of a made-up machine are devices, as far as the checks can tell."""
    port = who.port
    return replace(
        who,
        port=replace(
            port,
            device=replace(port.device, is_device=port.device.present),
            ioport=replace(port.ioport, is_device=port.ioport.present),
        ),
    )


def checked(who: Patient) -> dict[str, Finding]:
    return by_name(ask(PORT_CHECKS[who.config.port.kind], with_devices(who)))


def test_a_free_port_is_ours(tmp_path: Path) -> None:
    found = checked(patient(sound_machine(tmp_path)))
    assert {finding.state for finding in found.values()} == {State.OK}
    assert found["inputs"].found.startswith("pins 10, 12, 13, 15 high; 11 low; status register")
    assert found["outputs"].found == "Left with motors off: pins 1 high; 2 low."


def test_devport_warns_where_there_is_a_better_way(tmp_path: Path) -> None:
    root = sound_machine(tmp_path)
    found = checked(patient(root, **DEVPORT))
    assert {name for name, each in found.items() if each.state is not State.OK} == {"way"}
    (root / "dev/parport0").unlink()
    assert checked(patient(root, **DEVPORT))["way"].state is State.OK


def gone(root: Path) -> None:
    (root / "dev/parport0").unlink()


def printer(root: Path) -> None:
    put(root, "proc/modules", "lp 20480 0 - Live 0x0\n")
    put(root, "proc/sys/dev/parport/parport0/devices/lp/timeslice", "200\n")


def locked(root: Path) -> None:
    put(root, "sys/kernel/security/lockdown", "none [integrity] confidentiality\n")


ILLS: list[tuple[dict[str, Any], Callable[[Path], None], str, str]] = [
    ({}, gone, "device", "modprobe -a parport_pc ppdev"),
    ({}, gone, "permission", ""),
    ({}, printer, "printer driver", "rmmod lp"),
    (DEVPORT, locked, "lockdown", "ppdev"),
]


@pytest.mark.parametrize(("sections", "harm", "name", "change"), ILLS)
def test_what_keeps_the_port_from_us_is_bad(
    tmp_path: Path, sections: dict[str, Any], harm: Callable[[Path], None], name: str, change: str
) -> None:
    root = sound_machine(tmp_path)
    harm(root)
    finding = checked(patient(root, **sections))[name]
    assert finding.state is State.BAD
    assert change in finding.change


def test_a_plain_file_is_no_port(tmp_path: Path) -> None:
    who = patient(sound_machine(tmp_path))
    finding = by_name(ask(PORT_CHECKS["ppdev"], who))["device"]
    assert (finding.state, finding.found) == (
        State.BAD, "/dev/parport0 is not a device file.",
    )  # fmt: skip


@pytest.mark.parametrize(
    ("mode", "group", "change"),
    [("crw-rw----", "lp", "usermod -aG lp"), ("crw-------", "root", 'SUBSYSTEM=="ppdev"')],
)
def test_a_user_who_is_not_let_in_is_told_how(
    tmp_path: Path, mode: str, group: str, change: str
) -> None:
    who = patient(sound_machine(tmp_path))
    device = DeviceFacts("/dev/parport0", True, True, False, mode, "root", group)
    finding = checked(replace(who, port=replace(who.port, device=device)))["permission"]
    assert finding.state is State.BAD
    assert change in finding.change


def test_lockdown_and_an_idle_printer_driver_do_ppdev_no_harm(tmp_path: Path) -> None:
    root = sound_machine(tmp_path)
    locked(root)
    put(root, "proc/modules", "lp 20480 0 - Live 0x0\n")
    found = checked(patient(root))
    assert {finding.state for finding in found.values()} == {State.OK}


def test_a_port_that_does_not_open_is_told_in_its_own_words(tmp_path: Path) -> None:
    who = patient(sound_machine(tmp_path), opening=Opening(error="It is held by a scanner."))
    found = checked(who)
    assert (found["claim"].state, found["claim"].found) == (State.BAD, "It is held by a scanner.")
    assert found["inputs"].state is State.BAD
    assert found["outputs"].state is State.WARN


def test_the_simulated_mill_needs_no_port(tmp_path: Path) -> None:
    found = checked(patient(tmp_path, port={"kind": "simulation"}))
    assert [finding.state for finding in found.values()] == [State.OK]


# --- really opened -------------------------------------------------------------------------------


def test_outputs_are_left_off_whatever_the_claim_did() -> None:
    card = SmcCard(outputs=[OutputPin(14, True), OutputPin(17, False)])
    opening = try_port(NullPort, card)
    pins = dict(opening.pins)
    assert (pins[14], pins[17]) == (False, True), "off means low here, and high there"
    assert len(pins) == 12
    assert opening.lines is not None
    assert opening.lines.register == 0xF8


def test_every_kind_of_port_has_its_checks() -> None:
    assert set(PORT_CHECKS) == set(PORTS.ours)


def test_pins_are_told_from_registers() -> None:
    # Pins 1, 14 and 17 are inverted between register and plug, 16 is not.
    assert dict(output_pins(0x81, 0x0B)) == {
        1: False, 2: True, 3: False, 4: False, 5: False, 6: False, 7: False, 8: False, 9: True,
        14: False, 16: False, 17: False,
    }  # fmt: skip
    assert dict(output_pins(0, 0x04))[16]


def test_a_port_that_goes_away_meanwhile_is_an_error() -> None:
    class Gone(NullPort):
        def read_status(self) -> int:
            raise PortError("It does not answer any more.")

    assert try_port(Gone, SmcCard()) == Opening(error="It does not answer any more.")


@pytest.fixture
def fake(tmp_path: Path) -> FakePort:
    return FakePort(tmp_path)


def doctor(fake: FakePort, folder: Path, kind: str) -> tuple[int, dict[str, Any]]:
    """The command as a process that has the fake port."""
    (folder / "fraese.toml").write_text(
        f'[port]\nkind = "{kind}"\n[outputs]\nspindle = {{ pin = 14, active_high = true }}\n'
    )
    command = [sys.executable, "-m", "fraese", "doctor", "--json", "--no-load", "--seconds", "0.2"]
    done = subprocess.run(
        command,
        cwd=folder,
        env={**fake.environment(), "XDG_STATE_HOME": str(folder)},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.stdout, done.stderr
    said = json.loads(done.stdout.splitlines()[-1])
    assert isinstance(said, dict)
    return done.returncode, {check["name"]: check for check in said["checks"]}


@needs_fake_port
@pytest.mark.parametrize("kind", ["ppdev", "devport"])
def test_the_port_is_claimed_read_switched_off_and_given_back(
    fake: FakePort, tmp_path: Path, kind: str
) -> None:
    fake.press()
    _, checks = doctor(fake, tmp_path, kind)
    assert checks["claim"]["state"] == "ok"
    assert checks["inputs"]["state"] == "warn"
    assert f"{CONTACT:#04x}. Pin 11 shows contact." in checks["inputs"]["found"]
    whats = "".join(event.what for event in fake.events())
    assert re.fullmatch({"ppdev": "OEWWC[RW]*LX", "devport": "O[RW]*X"}[kind], whats), whats
    # Both phases of the third motor off, and the spindle relay's pin low.
    assert fake.data == 0x9B
    assert fake.control & 0x02


@needs_fake_port
def test_a_port_that_is_taken_is_bad_and_not_touched(fake: FakePort, tmp_path: Path) -> None:
    fake.refuse("claim", errno.ENXIO)
    code, checks = doctor(fake, tmp_path, "ppdev")
    assert code == 1
    assert checks["claim"]["state"] == "bad"
    assert "held by another program" in checks["claim"]["found"]
    assert fake.status == AT_REST
    assert fake.writes() == []
