"""Any accesses to a port, written down and read back: levels, edges, moments."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.motor import waveform
from fraese.motor.meaning import CoilCurrents, Meaning
from fraese.motor.phases import LEVEL_MAPS, currents_of
from fraese.motor.pins import CONTROL_PINS, DATA_PINS, STATUS_PINS, levels
from fraese.motor.seams import CONTROL, DATA, STATUS
from fraese.motor.waveform import Waveform
from fraese.waves.figures import LineFigures
from fraese.waves.stretch import Stretch
from fraese.waves.vcdfile import VcdFile
from tests.cli.test_trace_option import Wave

PINS: Final = {DATA: DATA_PINS, STATUS: STATUS_PINS, CONTROL: CONTROL_PINS}
ACCESSES = st.lists(
    st.tuples(
        st.sampled_from([0, 0, 1, 62, 5_000, 2_000_000_000]),
        st.sampled_from([DATA, STATUS, CONTROL]),
        st.integers(0, 255),
    ),
    min_size=1,
    max_size=60,
)


def written(path: Path, accesses: Sequence[tuple[int, int, int]], meaning: Meaning) -> int:
    """The waveform of accesses that come so many ns after one another; their last moment."""
    wave, at_ns = Waveform(path, "port", meaning), 7_000
    for after_ns, register, value in accesses:
        at_ns += after_ns
        wave.note(at_ns, register, value)
    wave.close(at_ns + 10_000)
    assert wave.is_whole
    return at_ns - 7_000 - accesses[0][0]


@given(ACCESSES, st.integers(1, 9))
def test_every_change_of_every_line_is_there_once(
    tmp_path_factory: pytest.TempPathFactory,
    accesses: list[tuple[int, int, int]],
    all_every: int,
) -> None:
    """Also where a line changes several times at one moment; for pyvcd and for our own reader."""
    path = tmp_path_factory.mktemp("waves") / "wave.vcd"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(waveform, "_ALL_EVERY", all_every)
        last_ns = written(path, accesses, Meaning({}))
    wave, file = Wave(path), VcdFile(path)
    assert file.end >= last_ns
    stretch = Stretch(file, file.begin, file.end, 20)
    for register, pins in PINS.items():
        for pin in pins:
            seen: list[bool] = []
            for _, written_to, value in accesses:
                high = levels(value, pins)[pin]
                if written_to == register and (not seen or seen[-1] != high):
                    seen.append(high)
            name = f"pin{pin:02d}_free"
            changes = [c for c in wave.changes[name] if c.value != "x"]
            assert [c.value == "1" for c in changes] == seen
            moments = [c.at_ns for c in changes]
            assert moments == sorted(set(moments))
            # A line that changes at one moment with itself is moved by a ns each time, no more.
            assert all(m <= last_ns + len(accesses) for m in moments)
            figures = next(s.figures for s in stretch.seen if s.line.name == name)
            assert isinstance(figures, LineFigures)
            # Our reader takes the first moment for how things were.
            assert figures.edges == len([m for m in moments[1:] if m > file.begin])


@given(st.lists(st.integers(0, 255), min_size=1, max_size=30))
def test_currents_are_those_of_the_byte_at_the_strobe(
    tmp_path_factory: pytest.TempPathFactory, data: list[int]
) -> None:
    path = tmp_path_factory.mktemp("waves") / "wave.vcd"
    field = LEVEL_MAPS["field"]
    meaning = Meaning({}, lambda: CoilCurrents({0: "x", 2: "c"}, field))
    latches = [
        access
        for byte in data
        for access in ((100, DATA, byte), (100, CONTROL, 1), (100, DATA, 0), (100, CONTROL, 0))
    ]
    written(path, latches, meaning)
    wave = Wave(path)
    for name, socket in (("x", 0), ("c", 2)):
        found = [currents_of(byte, field) for byte in data if byte >> 6 == socket]
        for coil, percents in (
            ("a", [current.a_percent for current in found]),
            ("b", [current.b_percent for current in found]),
        ):
            expected = [0]
            for percent in percents:
                if percent != expected[-1]:
                    expected.append(percent)
            assert [c.value for c in wave.changes[f"{name}_coil_{coil}"]] == expected
