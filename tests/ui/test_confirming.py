"""What can break something is asked for twice; what can be undone is undone."""

from fraese.ui.dialogs.confirm import ConfirmDialog
from tests.ui.helpers import bench, play


def test_switches_are_ignored_only_by_who_means_it() -> None:
    async def scene() -> None:
        async with bench() as b:
            controller = b.plant.controller
            await b.press("i")
            assert isinstance(b.app.screen, ConfirmDialog)
            await b.press("escape")
            await b.settled()
            assert not controller.state().switch_ignored
            await b.press("i", "tab", "enter")
            await b.settled()
            assert not controller.state().switch_ignored, "Back had the focus"
            await b.press("i", "enter")
            await b.settled()
            assert controller.state().switch_ignored
            await b.press("i")
            await b.settled()
            assert not controller.state().switch_ignored, "back to safety in one step"

    play(scene)


def test_a_work_zero_is_undone() -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.jog("right", "up")
            await b.press("X")
            await b.settled()
            await b.press("A")
            await b.settled()
            assert b.drawn.offset_mm == (1, 1, 0)
            assert "Ctrl+Z undoes it" in b.text("#message")
            await b.press("ctrl+z")
            await b.settled()
            assert b.drawn.offset_mm == (1, 0, 0)
            await b.press("ctrl+z")
            await b.settled()
            assert b.drawn.offset_mm == (0, 0, 0)
            await b.press("ctrl+z")
            await b.wait(lambda: "no work zero to undo" in b.text("#message"))

    play(scene)
