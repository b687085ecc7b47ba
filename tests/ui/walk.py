"""A walk through the app, from stop to stop: what the snapshots compare and the tour shows.

Rule 1: the clock is virtual, and nothing is shown that depends on the real one but the time of day,
        which ``without_time`` blanks.
Rule 2: a stop is left as it was found: dialogs are closed, the machine stands.
"""

import contextlib
import io
import re
import tomllib
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Final

from rich.console import Console
from textual.screen import ModalScreen

from fraese.assembly import Plant, assemble
from fraese.cli.appsettings import AppSettings
from fraese.config import Config
from fraese.program.byhand import ByHand
from fraese.program.program import open_program
from fraese.ui import FraeseApp
from fraese.ui.widgets.programpane import ProgramPane
from tests.ui.helpers import Bench

#: A plate with a pocket, some holes and its outline; it asks for a tool, a spindle and a look.
PART: Final = """\
( plate: a pocket, three holes, the outline )
G21 G90 G17
T2 M6
S12000 M3
G0 Z2
G0 X30 Y30
G1 Z-2 F120
G1 X50 F300
G3 X50 Y30 I-20 J0
G0 Z2
M0 (chips out of the pocket?)
G81 X10 Y10 Z-4 R2 F150
X90
Y50
G80
G0 X5 Y5
G1 Z-4 F120
G1 X95 F400
G1 Y50
G3 X90 Y55 I-5 J0
G1 X5
G1 Y5
G0 Z2
M5
M2
"""
MACHINE: Final = """\
[standstill]
delay_s = 0

[tools]
1 = { length_mm = 31.5, diameter_mm = 6, remark = "end mill" }
2 = { length_mm = 28, diameter_mm = 3, remark = "slot drill" }
7 = { length_mm = 45.25, diameter_mm = 0.2, remark = "engraver" }
"""
CONFIG: Final = Config.model_validate(tomllib.loads(MACHINE))
_TIME: Final = re.compile(r"\b\d\d:\d\d:\d\d\b")
#: What was on the lines before the first step depends on when somebody pressed the key.
_WAVES: Final = re.compile(r"\b(D\d|STR) +[▁▔│▒]+")
_HEARD: Final = re.compile(r"\d+ accesses in [\d.]+ ms")
#: How often the machine was asked while a message stood is the threads' affair.
_TIMES: Final = re.compile(r" +×\d+$", re.MULTILINE)
#: Where the thumb of a dialog's scrollbar ends depends on how much there is below.
_THUMB: Final = re.compile("[▁▂▃▅▆▇](?= *│)")
_KEYS: Final = re.compile(r"\b\d+ keys\b")
_ENDS: Final = re.compile(r"\bends\b(\s|&#160;)\d\d:\d\d\b")


@dataclass(frozen=True, slots=True)
class Stop:
    """Something to look at.

    Attributes:
        name: of its picture.
        is_view: a view that uses all the room there is.
    """

    name: str
    is_view: bool = False


@asynccontextmanager
async def app_on_the_way(folder: Path, size: tuple[int, int]) -> AsyncIterator[Bench]:
    """The app as the command line makes it, on the simulated mill.

    Args:
        folder: where the program is put.
        size: of the terminal.
    """
    path = folder / "plate.ngc"
    path.write_text(PART)
    (folder / "fraese.toml").write_text(MACHINE)
    # Names of files are told as they were given.
    with contextlib.chdir(folder):
        app, plant = _made(path)
        async with app.run_test(size=size) as pilot:
            b = Bench(app, plant, pilot)
            programs = app._programs
            await b.wait(
                lambda: programs.program is not None and programs.program.facts is not None
            )
            await b.wait(lambda: programs.look is None)
            yield b


def _made(program: Path) -> tuple[FraeseApp, Plant]:
    plant = assemble(CONFIG, clock="virtual")
    app = FraeseApp(
        plant.controller,
        machine_name=plant.machine_name,
        open_program=partial(open_program, apart=False),
        program=program,
        hand=plant.press,
        bench=plant.bench,
        tools=ByHand(),
        settings=AppSettings(Path("fraese.toml"), plant.controller),
    )
    return app, plant


async def walk(b: Bench) -> AsyncIterator[Stop]:
    """From the start to the log; each stop is drawn to its end when it is yielded."""
    await b.press("v")
    yield await _drawn(b, Stop("start", is_view=True))

    await b.press("e")
    for is_pressed in (True, False, True, False):
        await b.press("p")
        await b.wait(lambda wanted=is_pressed: b.drawn.switch_closed is wanted)  # type: ignore[misc]
    yield await _drawn(b, Stop("switches"))
    await b.press("escape", "r")
    yield await _drawn(b, Stop("reference"))
    await b.press("enter")
    await _at_rest(b)

    await b.press("g")
    await b.type("X40 Y20 Z-20")
    yield await _drawn(b, Stop("go-to"))
    await b.press("enter")
    await _at_rest(b)
    await b.press("A")
    await _at_rest(b)
    yield await _drawn(b, Stop("move", is_view=True))
    await b.press("f")
    yield await _drawn(b, Stop("offsets"))
    await b.press("escape", "T")
    yield await _drawn(b, Stop("tools"))
    await b.press("escape", "f3")
    await _at_rest(b)

    # What lies below a dialog is not drawn on.
    await _drawn(b, Stop("program"))
    await b.ask_to_start()
    yield await _drawn(b, Stop("brief"))
    await b.press("enter")
    await b.wait(lambda: b.drawn.waits_for == "tool 2")
    yield await _drawn(b, Stop("tool"))
    for asked in ("spindle", "M0"):
        b.app.link.answer()
        await b.wait(lambda asked=asked: b.drawn.waits_for == asked)  # type: ignore[misc]
    await b.wait(lambda: isinstance(b.app.screen, ModalScreen))
    await b.press("m")
    await b.wait(lambda: b.app.screen is b.app.view)
    await b.press("comma", "comma")
    yield await _drawn(b, Stop("program", is_view=True))
    await b.press("equals_sign")
    b.app.link.answer()
    await _at_rest(b)

    await b.press("f4")
    yield await _drawn(b, Stop("calibrate", is_view=True))
    await b.press("n")
    yield await _drawn(b, Stop("question"))
    await b.press("enter")
    await _at_rest(b)
    yield await _drawn(b, Stop("found", is_view=True))

    await b.press("f5")
    await b.wait(lambda: bool(getattr(b.app.view, "_listens", False)))
    await b.press("pageup")
    await _at_rest(b)
    yield await _drawn(b, Stop("bench", is_view=True))

    b.hand("xmin", True)
    await b.wait(lambda: b.drawn.switch_closed)
    await b.press("f6")
    yield await _drawn(b, Stop("log", is_view=True))
    b.hand("xmin", False)
    await b.wait(lambda: not b.drawn.switch_closed)
    # Where no time of day looks out from below the page.
    await b.press("f2")
    await _at_rest(b)
    await b.press("f1")
    yield await _drawn(b, Stop("help"))
    await b.press("escape", "f7")
    await b.wait(lambda: "axes.x" in as_text(b))
    yield await _drawn(b, Stop("settings", is_view=True))
    await b.press("e")
    yield await _drawn(b, Stop("setting"))
    await b.press("escape")


async def _at_rest(b: Bench) -> None:
    await b.settled()
    await b.wait(lambda: not b.drawn.energised)


async def _drawn(b: Bench, stop: Stop) -> Stop:
    """Wait until a look shows all there is."""
    await b.pilot.pause(0.3)
    for pane in b.app.view.query(ProgramPane):
        await b.wait(lambda pane=pane: not pane.toolpath.is_drawing)  # type: ignore[misc]
    await b.pilot.pause(0.3)
    return stop


def without_time(text: str) -> str:
    """What does not say when it was taken."""
    return _ENDS.sub(r"ends\g<1>12:00", _TIME.sub("12:00:00", text))


def as_text(b: Bench) -> str:
    """What is on the screen, in letters."""
    app, size = b.app, b.app.size
    console = Console(
        width=size.width, height=size.height, file=io.StringIO(), force_terminal=True,
        color_system="truecolor", record=True, legacy_windows=False, safe_box=False,
    )  # fmt: skip
    console.print(
        app.screen._compositor.render_update(
            full=True, screen_stack=app._background_screens, simplify=False
        )
    )
    rows = console.export_text(styles=False).split("\n")[: size.height]
    text = "\n".join(row.rstrip() for row in rows)
    text = _TIMES.sub("", _HEARD.sub("~ accesses", _WAVES.sub(r"\1 ~~~~", text)))
    return without_time(_KEYS.sub("all keys", _THUMB.sub(" ", text)))
