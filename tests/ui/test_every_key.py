"""Every key of the table is pressed where it works, and gives its action, once.

What the actions do, the other tests say. Here they are not done: it is written down which was
wanted, so that even the key that leaves can be pressed.
"""

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from textual.actions import parse
from textual.screen import Screen

from fraese.config import Config
from fraese.control.asleft import Left
from fraese.control.calibration.proposal import Proposal
from fraese.program.byhand import ByHand
from fraese.ui import FraeseApp
from fraese.ui.dialogs.ask import AskDialog
from fraese.ui.dialogs.byhand import ProbeDialog, SetDialog, TypedDialog
from fraese.ui.dialogs.confirm import ConfirmDialog
from fraese.ui.dialogs.consent import ConsentDialog
from fraese.ui.dialogs.crash import CrashDialog
from fraese.ui.dialogs.form import FormDialog
from fraese.ui.dialogs.goto import GoToDialog
from fraese.ui.dialogs.heldkey import HeldKeyPage
from fraese.ui.dialogs.help import HelpPage
from fraese.ui.dialogs.jograte import JogRateDialog
from fraese.ui.dialogs.open import MapDialog, OpenDialog
from fraese.ui.dialogs.reference import ReferenceDialog
from fraese.ui.dialogs.resume import ResumeDialog
from fraese.ui.dialogs.setting import SettingDialog
from fraese.ui.dialogs.start import StartDialog, WayDialog
from fraese.ui.dialogs.switches import SwitchPage
from fraese.ui.dialogs.tables import OffsetsDialog, ToolsDialog
from fraese.ui.keyrows import Area, Row
from fraese.ui.linehistory import LineHistory
from fraese.ui.views import VIEWS
from fraese.ui.widgets.scene import Scene
from tests.ui.helpers import Bench, FakeProgram, bench, play

#: Where keys work in more than one view, or everywhere.
SHARED = {Area.EVERYWHERE, Area.VIEWS, *(area for view in VIEWS.values() for area in view.ALSO)}
STOP = "stop_machine"
SETTING: Any = SimpleNamespace(
    key="run.confirm_spindle", sentence="When?", bounds="", choices=("first", "never"),
    default="first", at_once=True, value="first", is_text=True,
)  # fmt: skip
Opener = Callable[[Bench], Screen[Any]]


class NoResumption:
    """Nothing can be gone on with; that is enough to be looked at."""

    name, path, program, moves = "part.ngc", Path("part.ngc"), FakeProgram([]), 20

    def news(self) -> tuple[str, ...]:
        return ()

    def way(self, back: int, given_up: Callable[[], bool]) -> Any:
        raise NotImplementedError

    def start(self, controller: object, back: int) -> None:
        raise NotImplementedError


def start_dialog(b: Bench) -> StartDialog:
    state, shape = b.app.link.state(), b.app.link.shape
    return StartDialog(b.app._keys, FakeProgram(["G0"]), shape, state, Scene.of(state, None))


DIALOGS: dict[Area, Opener] = {
    Area.START: start_dialog,
    Area.START_THERE: lambda b: WayDialog(b.app._keys, ["to line 3"]),
    Area.GO_TO: lambda b: GoToDialog(b.app._keys, b.app.link, {}),
    Area.JOG_RATE: lambda b: JogRateDialog(b.app._keys, b.app.link, 600.0),
    Area.TYPED: lambda b: TypedDialog(b.app._keys, b.app.link, ByHand(), LineHistory(None)),
    Area.SET: lambda b: SetDialog(b.app._keys, b.app.link, {}),
    Area.OFFSETS: lambda b: OffsetsDialog(b.app._keys, b.app.link, b.app.link.shape.names),
    Area.TOOLS: lambda b: ToolsDialog(b.app._keys, b.app.link, None, ""),
    Area.PROBE: lambda b: ProbeDialog(b.app._keys, b.app.link, ByHand(), {}, Path("new.map")),
    Area.REFERENCE: lambda b: ReferenceDialog(b.app._keys, b.app.link.shape),
    Area.OPEN: lambda b: OpenDialog(b.app._keys, Path("/"), ""),
    Area.MAP: lambda b: MapDialog(b.app._keys, Path("/"), ""),
    Area.RESUME: lambda b: ResumeDialog(b.app._keys, NoResumption()),
    Area.CRASH: lambda b: CrashDialog(b.app._keys, Left("It crashed.", "It crashed.", "near")),
    Area.ASK: lambda b: AskDialog(b.app._keys, b.drawn.question),
    Area.CONFIRM: lambda b: ConfirmDialog(b.app._keys, "Break it", "It breaks.", "Break"),
    Area.SWITCHES: lambda b: SwitchPage(b.app._keys, b.app.link.shape, b.drawn, lambda *_: None),
    Area.FORM: lambda b: FormDialog(b.app._keys, "A question", "What?"),
    Area.CONSENT: lambda b: ConsentDialog(b.app._keys, Proposal((), ""), "fraese.toml"),
    Area.SETTING: lambda b: SettingDialog(b.app._keys, SETTING, "fraese.toml", str, str),
    Area.HELD_KEY: lambda b: HeldKeyPage(b.app._keys, b.app.view.desk.strokes),
    Area.HELP: lambda b: HelpPage(b.app._keys),
}


@pytest.fixture
def wanted(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, Any]]:
    """Actions that were wanted; none is done. A stop key leaves the key to others, as at rest.

    So do Textual's own keys, that scroll what cannot be scrolled.
    """
    found: list[tuple[str, Any]] = []

    async def note(app: FraeseApp, namespace: object, name: str, params: Any) -> bool:
        is_ours = any(parse(row.action)[1] == name for row in app._keys.rows)
        if is_ours:
            found.append((name, params))
        return is_ours and name != STOP

    monkeypatch.setattr(FraeseApp, "_dispatch_action", note)
    return found


async def pressed(b: Bench, row: Row, wanted: list[tuple[str, Any]]) -> list[str]:
    """Its keys that did not give its action, once."""
    _, name, params = parse(row.action)
    wrong = []
    for key in filter(None, row.keys.split(",")):
        del wanted[:]
        await b.press(key)
        others = [(name, params) for name, params in wanted if name != STOP]
        if (wanted[:1] if name == STOP else others) != [(name, params)]:
            wrong.append(f"{key}: {row.action}, not {wanted}")
    return wrong


def test_there_is_no_other_place_where_keys_work() -> None:
    assert {*SHARED, *(view.AREA for view in VIEWS.values()), *DIALOGS} == set(Area)


@pytest.mark.parametrize("name", VIEWS)
def test_every_key_of_a_view(name: str, wanted: list[tuple[str, Any]]) -> None:
    view = VIEWS[name]

    async def scene() -> None:
        async with bench(size=(120, 40)) as b:
            await b.show_view(name)
            await b.pilot.pause()
            wrong = []
            for row in b.app._keys.of(Area.EVERYWHERE, Area.VIEWS, view.AREA, *view.ALSO):
                wrong += await pressed(b, row, wanted)
            assert wrong == []

    play(scene)


@pytest.mark.parametrize("area", DIALOGS, ids=lambda area: area.name)
def test_every_key_of_a_dialog(area: Area, wanted: list[tuple[str, Any]]) -> None:
    async def scene() -> None:
        async with bench(config=Config()) as b:
            dialog = DIALOGS[area](b)
            assert getattr(dialog, "AREA", None) is area
            await b.app.push_screen(dialog)
            await b.pilot.pause()
            wrong = []
            for row in b.app._keys.of(Area.EVERYWHERE, area):
                wrong += await pressed(b, row, wanted)
            assert wrong == []

    play(scene)
