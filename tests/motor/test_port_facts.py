"""What is known about a port from outside, on file systems made for it."""

import os
from pathlib import Path

import pytest

from fraese.motor.ports import facts
from fraese.motor.ports.null import NullPort
from fraese.motor.ports.sim import INPUTS_AT_REST


def put(root: Path, path: str, text: str = "") -> None:
    place = root / path
    place.parent.mkdir(parents=True, exist_ok=True)
    place.write_text(text)


@pytest.fixture
def machine(tmp_path: Path) -> Path:
    """A machine with one free port, its drivers loaded, nothing locked down."""
    put(tmp_path, "dev/parport0")
    put(tmp_path, "dev/port")
    put(
        tmp_path,
        "proc/modules",
        "ppdev 24576 0 - Live 0x0\nparport_pc 40960 0 - Live 0x0\nparport 73728 2 ppdev,parport_pc"
        ", Live 0x0\n",
    )
    put(tmp_path, "proc/sys/dev/parport/parport0/base-addr", "888\t0\n")
    put(tmp_path, "proc/sys/dev/parport/parport0/devices/active", "none\n")
    put(tmp_path, "sys/kernel/security/lockdown", "[none] integrity confidentiality\n")
    return tmp_path


def test_a_free_port(machine: Path) -> None:
    found = facts.describe(root=machine)
    assert found.device.present
    assert found.device.allowed
    assert not found.device.is_device, "it is a plain file here"
    assert found.device.mode == "-rw-r--r--"
    assert (found.base, found.registered, found.openers) == (0x378, (), ())
    assert found.modules == ("parport_pc", "ppdev")
    assert (found.lockdown, found.is_locked_down) == ("none", False)
    assert not found.lp_holds_it


def test_the_printer_driver_has_it(machine: Path) -> None:
    put(machine, "proc/modules", "lp 20480 0 - Live 0x0\nppdev 24576 0 - Live 0x0\n")
    put(machine, "proc/sys/dev/parport/parport0/devices/lp/timeslice", "200\n")
    found = facts.describe(root=machine)
    assert found.modules == ("ppdev", "lp")
    assert found.registered == ("lp",)
    assert found.lp_holds_it


def test_another_program_has_it_open(machine: Path) -> None:
    put(machine, "proc/sys/dev/parport/parport0/devices/ppdev0/timeslice", "200\n")
    put(machine, "proc/4711/comm", "scanner\n")
    (machine / "proc/4711/fd").mkdir()
    (machine / "proc/4711/fd/5").symlink_to(machine / "dev/parport0")
    (machine / f"proc/{os.getpid()}/fd").mkdir(parents=True)
    (machine / f"proc/{os.getpid()}/fd/3").symlink_to(machine / "dev/parport0")
    found = facts.describe(root=machine)
    assert found.openers == ("scanner, pid 4711",)
    assert found.registered == ("ppdev0",)
    assert not found.lp_holds_it


def test_a_link_is_as_good_as_the_device(machine: Path) -> None:
    put(machine, "proc/sys/dev/parport/parport0/devices/lp/timeslice", "200\n")
    (machine / "dev/mill").symlink_to("parport0")
    found = facts.describe("/dev/mill", machine)
    assert found.device.present
    assert (found.base, found.registered) == (0x378, ("lp",))


def test_each_port_has_its_own_facts(machine: Path) -> None:
    put(machine, "proc/sys/dev/parport/parport1/base-addr", "53264\t0\n")
    put(machine, "proc/sys/dev/parport/parport1/devices/lp/timeslice", "200\n")
    second = facts.describe("/dev/parport1", machine)
    assert (second.base, second.registered) == (0xD010, ("lp",))
    assert not second.device.present
    assert facts.describe("/dev/parport0", machine).registered == ()
    assert facts.describe("/dev/parport", machine).base is None


@pytest.mark.parametrize(
    ("text", "state", "is_locked"),
    [
        ("[none] integrity confidentiality\n", "none", False),
        ("none [integrity] confidentiality\n", "integrity", True),
        ("none integrity [confidentiality]\n", "confidentiality", True),
        ("", "", False),
    ],
)
def test_lockdown(machine: Path, text: str, state: str, is_locked: bool) -> None:
    put(machine, "sys/kernel/security/lockdown", text)
    found = facts.describe(root=machine)
    assert (found.lockdown, found.is_locked_down) == (state, is_locked)


def test_where_there_is_nothing_nothing_is_said(tmp_path: Path) -> None:
    found = facts.describe(root=tmp_path)
    assert found.device == facts.DeviceFacts("/dev/parport0", present=False)
    assert found.ioport == facts.DeviceFacts("/dev/port", present=False)
    assert (found.base, found.modules, found.registered) == (None, (), ())
    assert (found.openers, found.lockdown) == ((), "")


def test_a_character_device_is_known_as_one() -> None:
    null = facts.device_facts("/dev/null")
    assert (null.present, null.is_device, null.allowed) == (True, True, True)
    assert (null.mode[0], null.owner) == ("c", "root")


def test_an_owner_without_a_name_is_a_number(machine: Path) -> None:
    if os.getuid() != 0:
        pytest.skip("needs root to give a file away")
    os.chown(machine / "dev/parport0", 54321, 54322)
    found = facts.device_facts("/dev/parport0", machine)
    assert (found.owner, found.group) == ("54321", "54322")


def test_what_may_not_be_looked_at_is_passed_over(machine: Path) -> None:
    put(machine, "proc/12/fd", "a file where a folder should be")
    put(machine, "proc/13/fd/7", "no link")
    assert facts.openers("/dev/parport0", machine) == ()


def test_inputs_are_told_by_pin_as_levels() -> None:
    """At rest all bits read 1: pin 11 is inverted between register and pin, so it is low."""
    lines = facts.status_lines(NullPort())
    assert lines.register == INPUTS_AT_REST
    assert lines.pins == ((10, True), (11, False), (12, True), (13, True), (15, True))
