"""Files of a machine: a name that every file system holds, and no two machines with one."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.journal import machine_file


@pytest.mark.parametrize(
    ("kind", "device", "name"),
    [
        ("simulation", "", "simulation.journal"),
        ("ppdev", "/dev/parport0", "ppdev-parport0.journal"),
        ("bridge", "/dev/ttyUSB0", "bridge-ttyUSB0.journal"),
        ("bridge", "", "bridge.journal"),
    ],
)
def test_names_as_people_expect_them(kind: str, device: str, name: str) -> None:
    assert machine_file(Path("state"), kind, device) == Path("state") / name


@given(st.text(max_size=300), st.text(max_size=300))
def test_no_two_devices_have_one_name(one: str, other: str) -> None:
    folder = Path("state")
    names = [machine_file(folder, "bridge", device) for device in (one, other)]
    assert (names[0] == names[1]) == (one == other)
    for path in names:
        assert path.parent == folder
        assert len(path.name.encode()) < 100


def test_neighbours_differ() -> None:
    devices = ["/dev/a/b", "/dev/a-b", "/dev/a_b", "a-b", "/dev/../a", "..", "/dev/ab", "ab"]
    assert len({machine_file(Path(), "bridge", device).name for device in devices}) == len(devices)
