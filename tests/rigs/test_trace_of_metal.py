"""``--trace`` on a parallel port: what the fake port saw stands in the file."""

import json
from pathlib import Path

import pytest

from fraese.motor.pins import CONTROL_PINS, DATA_PINS, levels
from fraese.motor.seams import CONTROL, DATA
from tests.cli.test_trace_option import Wave
from tests.rigs.lpt.fakeport import FakePort, missing

pytestmark = pytest.mark.skipif(bool(missing()), reason=missing())

_PINS = {DATA: DATA_PINS, CONTROL: CONTROL_PINS}
#: From the note of a write to the write, on a busy machine, ns.
_LATE_NS = 50_000_000


@pytest.mark.parametrize("port", ["ppdev", "devport"])
@pytest.mark.parametrize("card", ["smc1500", "stepdir"])
def test_the_waveform_is_what_the_port_saw(tmp_path: Path, port: str, card: str) -> None:
    """Every level after every write, in the same order, a moment before it."""
    fake = FakePort(tmp_path)
    (tmp_path / "fraese.toml").write_text(
        f'[card]\nkind = "{card}"\n[port]\nkind = "{port}"\nbase = 0x378\n'
    )
    said = json.loads(
        fake.python(
            "fraese", "move", "X1", "Y0.4", "--fresh", "--json",
            *("--config", str(tmp_path / "fraese.toml")),
            *("--state", str(tmp_path / "state")),
            *("--trace", str(tmp_path / "job.vcd")),
        )
    )  # fmt: skip
    assert said["trace"]["missing"] == 0
    wave = Wave(tmp_path / "job.vcd")
    seen: dict[int, list[tuple[int, bool]]] = {}
    events = [e for e in fake.events() if e.what == "W" and e.register in _PINS]
    first_ns = 0
    for event in events:
        for pin, high in levels(event.value, _PINS[event.register]).items():
            line = seen.setdefault(pin, [])
            if not line or line[-1][1] != high:
                line.append((event.at_ns, high))
    for pin, line in seen.items():
        (name,) = (name for name in wave.changes if name.startswith(f"pin{pin:02d}_"))
        noted = [c for c in wave.changes[name] if c.value != "x"]
        # The opening writes what it reads, before there is a card.
        own = line[-len(noted) :]
        assert [c.value == "1" for c in noted] == [high for _, high in own]
        first_ns = first_ns or own[0][0] - noted[0].at_ns
        late_ns = [at - first_ns - c.at_ns for (at, _), c in zip(own, noted, strict=True)]
        assert max(late_ns) - min(late_ns) < _LATE_NS
    if card == "stepdir":
        assert len(wave.edges("pin03_x_clock", "1")) == said["steps"]["x"] == 200
        assert len(wave.edges("pin05_y_clock", "1")) == said["steps"]["y"] == 80
    else:
        assert {c.value for c in wave.changes["x_coil_a"]} == {0, 60, 100, -60, -100}


def test_a_program_of_x4step_on_a_parallel_port(tmp_path: Path) -> None:
    fake = FakePort(tmp_path)
    (tmp_path / "fraese.toml").write_text('[x4step.lpt2]\nkind = "ppdev"\n')
    player = fake.start(
        "fraese", "bench", "2", "--config", str(tmp_path / "fraese.toml"),
        *("--trace", str(tmp_path / "lines.vcd")),
    )  # fmt: skip
    player.communicate("s1\nd50\nf1000\nr0\ng\ns2\nd-20\ng\nq\n", timeout=60)
    assert player.returncode == 0
    wave = Wave(tmp_path / "lines.vcd")
    # The second motion is of both axes.
    assert len(wave.edges("pin03_clock1", "1")) == 100
    assert len(wave.edges("pin05_clock2", "1")) == 20
    assert wave.changes["pin17_active"][-1].value == "0"
    # The note is made just before the write: the lead can be a little longer, not shorter.
    second = wave.changes["pin04_direction2"][-1].at_ns
    assert all(abs(at - second) >= 100_000 for at in wave.edges("pin05_clock2", "1"))
