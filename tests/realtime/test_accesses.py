"""The way of an access from the step process into a file."""

import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.motor.cards.stepdir import StepDirCard
from fraese.motor.meaning import Meaning
from fraese.motor.ports.null import NullPort
from fraese.motor.realtime import accesses
from fraese.motor.realtime.accesses import AccessRing, ChildTrace, open_traced
from fraese.motor.realtime.setup import Setup
from fraese.motor.seams import DATA
from fraese.motor.waveform import Waveform
from tests.cli.test_trace_option import Wave


@given(st.lists(st.integers(0, 40), max_size=40))
def test_what_is_put_is_taken_in_order_or_counted(bursts: list[int]) -> None:
    """Between two bursts one chunk is taken: the writer never waits, nothing comes twice."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(accesses, "_ACCESSES", 16)
        patch.setattr(accesses, "_MASK", 15)
        patch.setattr(accesses, "_CHUNK", 5)
        fd = AccessRing.create()
        writer, reader = AccessRing(fd), AccessRing(fd)
        put = missing = 0
        taken: list[tuple[int, int, int]] = []
        for burst in bursts:
            for _ in range(burst):
                put += 1
                writer.put(put, put % 3, put % 256)
            taken += reader.take()
            missing += reader.newly_missing()
        while rest := list(reader.take()):
            taken += rest
        writer.close()
        reader.close()
        os.close(fd)
    assert len(taken) + missing == put
    moments = [at for at, _, _ in taken]
    assert moments == sorted(set(moments))
    assert all((register, value) == (at % 3, at % 256) for at, register, value in taken)


def test_accesses_of_an_opened_port_stand_in_the_file(tmp_path: Path) -> None:
    waveform = Waveform(tmp_path / "wave.vcd", "port", Meaning({2: "d", 17: "active"}))
    trace = ChildTrace(waveform)
    setup = trace.on(Setup(NullPort, StepDirCard()))
    (fd,) = setup.inherited
    for value in (1, 2):
        # The second one is who comes after the first has died.
        port = setup.open_port()
        port.write_data(value)
        port.write_control(8 * (value - 1))
        assert port.read_status() == 0xF8
    assert open_traced(NullPort, fd).read_status() == 0xF8
    trace.close()
    trace.close()
    wave = Wave(tmp_path / "wave.vcd")
    assert [change.value for change in wave.changes["pin02_d"]] == ["x", "1", "0"]
    assert [change.value for change in wave.changes["pin03_free"]] == ["x", "0", "1"]
    # Pin 17 is inverted.
    assert [change.value for change in wave.changes["pin17_active"]] == ["x", "1", "0"]
    assert [change.value for change in wave.changes["pin11_free"]] == ["x", "0"]
    assert waveform.is_whole


def test_a_file_that_fills_up_ends_and_says_so(tmp_path: Path) -> None:
    waveform = Waveform(tmp_path / "wave.vcd", "port", Meaning({}))

    class Full:
        closed = False

        def write(self, text: str) -> int:
            raise OSError(28, "No space left on device")

        def close(self) -> None:
            raise OSError(28, "No space left on device")

    waveform.note(1_000, DATA, 1)
    waveform._file.close()
    waveform._file = Full()  # type: ignore[assignment]
    waveform.note(2_000_001_000, DATA, 0)
    waveform.note(3_000_001_000, DATA, 1)
    waveform.close(4_000_001_000)
    assert not waveform.is_whole
    assert "No space left on device; the job went on without it." in waveform.sentence()


def test_missing_accesses_are_told_of_where_they_are_missing(tmp_path: Path) -> None:
    waveform = Waveform(tmp_path / "wave.vcd", "port", Meaning({}))
    waveform.note(0, DATA, 1)
    waveform.skip(12)
    waveform.note(5_000, DATA, 2)
    waveform.close(6_000)
    text = (tmp_path / "wave.vcd").read_text()
    assert text.index("$comment 12 accesses are missing here $end") < text.index("#5000")
    assert waveform.sentence().endswith("12 accesses are missing.")
    assert len(Wave(tmp_path / "wave.vcd").edges("pin02_free", "0")) == 1
