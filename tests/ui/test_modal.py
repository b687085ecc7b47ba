"""The strip of what is in force, and the word that says what a program waits for."""

from dataclasses import replace
from pathlib import Path

import pytest

from fraese.assembly import assemble
from fraese.config import Config
from fraese.control.cutting import Cutting
from fraese.control.state import MachineState, Status, WorkFacts
from fraese.program.program import open_program
from fraese.ui.widgets.modal import in_force
from fraese.ui.widgets.statebar import seen
from tests.ui.helpers import bench, play

TOOLS = {"1": {"length_mm": 12.5, "diameter_mm": 3}}
PART = "G21 G90\nG0 X1\nT1 M6\nG43\nS12000 M3\nG1 X5 F300\nM1\nG1 X6 F240\nM0\nM5\nG0 X7\nM0\nM2\n"


def a_state(**changes: object) -> MachineState:
    return replace(assemble(Config()).controller.state(), **changes)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({}, "G54"),
        ({"override": 0.8}, "G54 | feed 80%"),
        ({"cutting": Cutting(300.0), "override": 0.8}, "G54 | F300 × 80% = 240"),
        ({"cutting": Cutting(300.0), "rapid_override": 0.5}, "G54 | F300 | rapids 50%"),
        ({"cutting": Cutting(0, 1, 12000.0, True)}, "G54 | S12000 on by hand"),
        ({"cutting": Cutting(0, -1, 800.0)}, "G54 | S800 on, to the left"),
        ({"cutting": Cutting(0, 0, 800.0)}, "G54 | S800 off"),
        ({"cutting": Cutting(0, 1, 500.0, is_laser=True)}, "G54 | S500 laser on"),
        ({"cutting": Cutting(0, 1, 500.0, False, True, 50.0)}, "G54 | S500 laser 50%"),
        ({"cutting": Cutting(0, -1, 125.0, False, True, 12.5)}, "G54 | S125 laser 12.5% M4"),
        ({"cutting": Cutting(0, 0, 125.0, False, True, 12.5)}, "G54 | S125 off"),
        (
            {"work": WorkFacts("G55", True, 30.0, 2, (0.0, 0.0, 12.5), 12.5, 3.0)},
            "G55 | G92 | R30° | T2 | D3 | G43 12.5",
        ),
        ({"single_block": True, "block_delete": True}, "G54 | single block | / left out"),
    ],
)
def test_what_is_in_force_in_words(changes: dict[str, object], words: str) -> None:
    assert " | ".join(in_force(a_state(**changes))) == words


def test_a_wait_names_what_it_waits_for() -> None:
    asked = a_state(status=Status.RUN, question="Tool change.", waits_for="tool 2")
    assert seen(asked, False).word == "WAIT tool 2"
    assert seen(replace(asked, waits_for=""), False).word == "WAIT"


@pytest.mark.parametrize("size", [(80, 24), (120, 40)])
def test_the_strip_follows_the_motors(tmp_path: Path, size: tuple[int, int]) -> None:
    """The interpreter is far ahead; what is shown is what the motors are at."""
    path = tmp_path / "part.nc"
    path.write_text(PART)
    config = Config.model_validate({"tools": TOOLS, "run": {"optional_stop": True}})
    field = "#work" if size[0] == 80 else "#modal"

    async def scene() -> None:
        async with bench(size=size, config=config) as b:
            b.app.link.order_of(open_program(path).start)
            for word, said in (
                ("tool 1", "G54  M1 stops"),
                ("spindle", "G54  T1  D3  G43 12.5  M1 stops"),
                ("M1", "G54  T1  D3  G43 12.5  S12000 on by hand  F300  M1 stops"),
                ("M0", "G54  T1  D3  G43 12.5  S12000 on by hand  F240  M1 stops"),
                ("M0", "G54  T1  D3  G43 12.5  S12000 off  F240  M1 stops"),
            ):
                close = " ".join(said.split("  "))
                shown = (said, close)
                await b.wait(lambda shown=shown: b.text(field) in shown)  # type: ignore[misc]
                await b.wait(lambda word=word: b.text("#word") == f"WAIT {word}")  # type: ignore[misc]
                b.app.link.answer()
            await b.settled()

    play(scene)


@pytest.mark.parametrize(("output", "left"), [(None, "S12000 on by hand"), (14, "S12000 off")])
def test_after_a_stop_the_strip_says_what_still_turns(
    tmp_path: Path, output: int | None, left: str
) -> None:
    """A spindle on an output is switched off, one that is switched by hand is not."""
    path = tmp_path / "part.nc"
    path.write_text("G21 G90\nS12000 M3\nG1 X5 F300\nM0\nM5\nM2\n")
    config = Config.model_validate(
        {
            "run": {"confirm_spindle": "never"},
            "outputs": {} if output is None else {"spindle": {"pin": output}},
        }
    )

    async def scene() -> None:
        async with bench(config=config) as b:
            b.app.link.order_of(open_program(path).start)
            await b.wait(lambda: b.drawn.waits_for == "M0")
            b.app.link.brake()
            await b.settled()
            assert left in in_force(b.drawn)

    play(scene)
