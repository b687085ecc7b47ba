"""A card in a package of its own: it is found, driven, simulated and refused like one of ours."""

import re
from pathlib import Path
from typing import Any

import pytest

from fraese.assembly import Plant, assemble
from fraese.config import Config
from fraese.config import file as configuration
from fraese.control.state import Status
from fraese.errors import ConfigError
from fraese.kinds.card import card_kind, card_of
from fraese.kinds.smc1500 import CARD as SMC
from fraese.motor.realtime.measure import edge_of
from fraese.motor.seams import CONTROL, DATA
from fraese.peers import CARDS, PORTS
from tests.beside import EXAMPLES, install

ULN = EXAMPLES / "uln2003"


@pytest.fixture
def uln(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Config:
    """The example machine, with its package installed."""
    install(ULN, monkeypatch, tmp_path / "site-packages")
    return configuration.load(ULN / "fraese.toml")


def home(plant: Plant) -> None:
    plant.controller.home()
    assert plant.controller.run() is Status.OK, plant.controller.state().message


def test_it_drives_its_motors_and_loses_no_step(uln: Config) -> None:
    plant = assemble(uln)
    home(plant)
    plant.controller.move_to({"x": 3.25, "y": 2.5})
    assert plant.controller.run() is Status.OK
    state = plant.controller.state()
    assert state.work_mm == (3.25, 2.5)
    assert state.carriages_mm == pytest.approx((3.25, 2.5), abs=1 / 2048)
    assert state.lost_steps == (0, 0)
    assert state.step_word == "half-step"
    plant.close()


def test_a_motor_that_is_asked_for_too_much_is_left_behind(uln: Config) -> None:
    """The simulation is one: with a start/stop rate above the motor's it does not follow."""
    slow = uln.simulation.model_copy(update={"start_turns_s": 1.0, "acceleration_turns_s2": 1.0})
    plant = assemble(uln.model_copy(update={"simulation": slow}))
    plant.controller.jog("x", 1.0)
    plant.controller.run()
    assert plant.controller.state().lost_steps[0] != 0
    plant.close()


def test_all_motors_are_in_one_byte_and_there_is_no_strobe(uln: Config, tmp_path: Path) -> None:
    file = tmp_path / "uln.vcd"
    plant = assemble(uln, trace=file)
    plant.controller.jog("x", 0.05)
    plant.controller.run()
    plant.close()
    names = re.findall(r"\$var \w+ \d+ \S+ (\S+)", file.read_text("utf-8"))
    coils = [f"{axis}_coil_{coil}" for axis in "xy" for coil in "abcd"]
    assert [name.partition("_")[2] for name in names if "coil" in name] == coils
    assert not [name for name in names if "nstrobe" in name]


def test_the_doctor_knows_its_steps(uln: Config) -> None:
    """By the byte itself: there is neither a clock nor a strobe."""
    assert edge_of(card_of(uln)) == (DATA, 0xFF)
    assert edge_of(card_of(Config())) == (CONTROL, 0x01)
    stepdir = configuration.from_table({"card": {"kind": "stepdir"}}, "test")
    assert edge_of(card_of(stepdir)) == (DATA, 0xAA)


def test_its_position_is_kept_like_any_other(uln: Config, tmp_path: Path) -> None:
    plant = assemble(uln, state=tmp_path)
    home(plant)
    plant.controller.move_to({"x": 1.5})
    plant.controller.run()
    plant.close()
    again = assemble(uln, state=tmp_path)
    assert again.controller.state().work_mm[0] == 1.5
    assert all(again.controller.state().referenced)
    again.close()


def test_it_is_a_choice_wherever_cards_are(uln: Config) -> None:
    assert CARDS.names == ("smc1500", "stepdir", "uln2003")
    kinds = configuration.schema()["$defs"]["CardConfig"]["properties"]["kind"]["enum"]
    assert kinds == list(CARDS.names)
    assert "One of: smc1500, stepdir, uln2003." in configuration.annotated(uln)


def test_a_bridge_says_that_it_cannot_play_it(uln: Config) -> None:
    kind = card_kind(uln)
    with pytest.raises(ConfigError, match=r'card.kind "uln2003" is not on the bridge'):
        kind.facts(card_of(uln), "uln2003")


def test_it_has_two_sockets_and_the_configuration_knows(uln: Config) -> None:
    with pytest.raises(ConfigError, match=r'card.kind "uln2003" drives 2 motors at most'):
        configuration.from_table({"card": {"kind": "uln2003"}}, "test")


def test_who_has_not_installed_it_is_told_what_there_is() -> None:
    with pytest.raises(ConfigError, match="must be 'smc1500' or 'stepdir', not uln2003"):
        configuration.load(ULN / "fraese.toml")


def package(folder: Path, group: str, place: str, **modules: str) -> Path:
    """A package of one module and one entry point, named "own"."""
    folder.mkdir()
    (folder / "pyproject.toml").write_text(
        f'[project]\nname = "their-own"\nversion = "1"\n'
        f'[project.entry-points."{group}"]\nown = "{place}"\n'
    )
    for name, text in modules.items():
        (folder / f"{name}.py").write_text(text)
    return folder


@pytest.mark.parametrize(
    ("place", "said"),
    [
        ("nowhere_at_all:CARD", "its package their-own cannot be loaded: ModuleNotFoundError"),
        ("own_broken:CARD", "its package their-own cannot be loaded: ZeroDivisionError"),
        ("own_other:CARD", "own_other:CARD of its package their-own is no"),
        ("own_other:NONE", "its package their-own cannot be loaded: AttributeError"),
    ],
)
def test_a_package_that_cannot_be_used_stops_only_who_names_it(
    place: str, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = package(
        tmp_path / "own", "fraese.cards", place, own_broken="1 / 0", own_other="CARD = 1"
    )
    install(folder, monkeypatch, tmp_path / "site-packages")
    with pytest.raises(ConfigError, match=f'card.kind "own": {said}'):
        configuration.from_table({"card": {"kind": "own"}}, "test")
    assert configuration.from_table({}, "test") == Config()
    assert card_kind(Config()) is SMC


def test_a_name_of_ours_is_ours(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "own"
    folder.mkdir()
    (folder / "pyproject.toml").write_text(
        '[project]\nname = "thief"\nversion = "1"\n'
        '[project.entry-points."fraese.cards"]\nsmc1500 = "nowhere:CARD"\n'
    )
    install(folder, monkeypatch, tmp_path / "site-packages")
    assert CARDS.names == ("smc1500", "stepdir")
    assert CARDS.record("smc1500") is SMC


@pytest.mark.parametrize("name", CARDS.ours)
def test_every_card_of_ours_has_its_record(name: str) -> None:
    kind: Any = CARDS.record(name)
    config = configuration.from_table({"card": {"kind": name}}, "test")
    assert kind.make(config).motors == 3
    assert kind.sockets >= 3
    assert kind.facts(kind.make(config), name).motors == 3


def test_every_port_of_ours_has_its_record() -> None:
    assert {name for name in PORTS.ours if PORTS.record(name).opens} == {"ppdev", "devport"}
