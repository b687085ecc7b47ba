"""Whole commands on a parallel port, as a person types them: the fake port with a machine on it."""

import errno
import json
from pathlib import Path

import pytest

from tests.rigs.lpt.fakeport import missing
from tests.rigs.lpt.shop import SEEN, SHORT_MM, Shop, SimulatedShop
from tests.rigs.lpt.steps import check_motors_off

pytestmark = pytest.mark.skipif(bool(missing()), reason=missing())

#: All of a job is in the queue before it begins.
LEAD_S = 10


@pytest.mark.parametrize(
    ("port", "wiring", "commands"),
    [
        ("ppdev", "smc", ["home", "move X1 Y1.5", "jog X -0.3", "run part.ngc"]),
        ("devport", "x4step", ["home", "run part.ngc"]),
    ],
)
def test_commands_do_what_they_do_on_the_simulated_mill(
    tmp_path: Path, port: str, wiring: str, commands: list[str]
) -> None:
    """Byte for byte, and the carriages are where the command says."""
    shop = Shop(tmp_path / "metal", port, wiring, SHORT_MM, LEAD_S)
    simulated = SimulatedShop(tmp_path / "simulated", wiring, SHORT_MM, LEAD_S)
    zero_steps: tuple[int, ...] = ()
    for typed in commands:
        words = [*typed.split(), "--json"]
        answer, expected = shop.command(*words), simulated.command(*words)
        assert (answer.code, expected.code) == (0, 0), (answer, expected)
        assert answer.facts == expected.facts
        assert [answer.result[name] for name in SEEN] == [None] * len(SEEN)
        # It may be told of late ticks, too.
        assert answer.result["message"].startswith(expected.result["message"])
        assert answer.writes == expected.writes
        # Machine zero is where the reference run ended.
        zero_steps = zero_steps or shop.travelled_steps()
        position_steps = answer.facts["position_steps"].values()
        assert shop.travelled_steps() == tuple(
            zero + steps for zero, steps in zip(zero_steps, position_steps, strict=True)
        )
        if wiring == "smc":
            check_motors_off(answer.writes)
    assert shop.kept()["referenced"] == [True] * 3
    assert not shop.kept()["motion"]
    events = "".join(event.what for event in shop.fake.events())
    assert events.endswith({"ppdev": "LX", "devport": "X"}[port])


def test_an_end_switch_stops_a_move_and_is_named(tmp_path: Path) -> None:
    shop = Shop(tmp_path, "ppdev", "smc", SHORT_MM)
    answer = shop.command("move", "X5", "--json")
    assert answer.code == 1
    assert answer.result["status"] == "alarm"
    assert "xmax" in answer.result["message"]
    assert answer.result["position_steps"]["x"] == shop.travelled_steps()[0]
    check_motors_off(answer.writes)
    seen = json.loads(shop.command("switches", "--json").said)
    assert seen["switch_closed"]
    assert "xmax" in seen["ends"]


REFUSALS = [
    ("ppdev", "exclusive", errno.ENXIO, "sudo rmmod lp."),
    ("devport", "open port", errno.EPERM, 'port.kind "ppdev" needs none of this.'),
]


@pytest.mark.parametrize(("port", "call", "number", "helps"), REFUSALS)
def test_a_port_that_cannot_be_had_is_one_sentence(
    tmp_path: Path, port: str, call: str, number: int, helps: str
) -> None:
    shop = Shop(tmp_path, port)
    shop.fake.refuse(call, number)
    answer = shop.command("home", "--json")
    assert answer.code == 1
    assert answer.result["status"] == "refused"
    sentence = answer.result["message"]
    assert sentence.endswith(helps)
    assert answer.noted == f"fraese: {sentence}\n"
    assert shop.fake.writes() == []
