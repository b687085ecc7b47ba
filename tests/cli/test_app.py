"""The app as the command line makes it."""

from pathlib import Path

from fraese.assembly import assemble
from fraese.cli.shared import Drive
from fraese.cli.theapp import make_app
from fraese.config import Config
from fraese.control.state import Status
from fraese.testing import App
from fraese.ui.dialogs.crash import CrashDialog
from tests.helpers import crash, kept
from tests.ui.helpers import play


def test_the_state_says_that_the_machine_moves_before_it_moves(tmp_path: Path) -> None:
    async def scene() -> None:
        plant = assemble(Config(), state=tmp_path)
        app = make_app(plant, None, Drive(state=tmp_path))

        def is_moving() -> bool:
            return bool(kept(tmp_path).get("motion"))

        async with app.run_test(size=(80, 24)) as pilot:
            await pilot.press("X")
            await pilot.pause()
            assert not is_moving()
            await pilot.press("right")
            while app.busy or plant.controller.position.position_steps[0] != 200:
                await pilot.pause(0.01)
            assert is_moving()
        plant.close()
        assert not is_moving()

    play(scene)


def test_the_app_is_told_what_it_drives(tmp_path: Path) -> None:
    path = tmp_path / "part.ngc"
    path.write_text("G21 G90\nG1 X5 F300\nM2\n")
    with App(folder=tmp_path, program=path) as app:
        desk = app.ui.view.desk
        app.wait(lambda: desk.programs.program is not None, "the program")
        assert desk.programs.program is not None
        assert desk.programs.program.name == "part.ngc"
        assert desk.machine_name == "simulated mill"
        assert desk.hand is not None
        desk.hand("xmax", True)
        app.wait(lambda: app.ui._state.switch_closed, "the switch to be seen")
        desk.hand("xmax", False)


def test_what_a_crash_has_left_is_offered_at_the_start(tmp_path: Path) -> None:
    made = assemble(Config(), state=tmp_path)
    made.controller.home()
    assert made.controller.run() is Status.OK
    crash(made)

    async def scene() -> None:
        plant = assemble(Config(), state=tmp_path)
        app = make_app(plant, None, Drive(state=tmp_path))
        async with app.run_test(size=(80, 24)) as pilot:
            while not isinstance(app.screen, CrashDialog):
                await pilot.pause(0.01)
            await pilot.press("l")
            while not all(app._state.referenced):
                await pilot.pause(0.01)
        plant.close()

    play(scene)
    assert kept(tmp_path)["referenced"] == [True, True, True]
    assert kept(tmp_path)["doubt"] is None
