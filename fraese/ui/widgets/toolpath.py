"""The toolpath, drawn from two sides; see ``pathpane.py`` for how."""

from typing import Any

from textual import events
from textual.app import ComposeResult
from textual.containers import Vertical
from textual.geometry import Size

from fraese.ui.widgets.pathpane import PathPane
from fraese.ui.widgets.projection import SIDES, XY, XZ
from fraese.ui.widgets.scene import Scene, Spot, Way


class Toolpath(Vertical):
    """The toolpath: large from one side, below from another.

    Attributes:
        scene: what there is.
    """

    #: A lower field shows one side only.
    BOTH_FROM_ROWS = 14

    def __init__(self, **options: Any) -> None:
        options.setdefault("id", "toolpath")
        super().__init__(**options)
        self.scene = Scene()
        self._main = PathPane(self.scene, XY, id="toolpath-main")
        self._below = PathPane(self.scene, XZ, id="toolpath-below")

    def compose(self) -> ComposeResult:
        """One above the other."""
        yield self._main
        yield self._below

    @property
    def panes(self) -> tuple[PathPane, PathPane]:
        """The large one, and that below."""
        return self._main, self._below

    @property
    def is_drawing(self) -> bool:
        """A picture is not whole yet."""
        return any(pane.is_drawing for pane in self.panes if pane.display)

    def on_resize(self, event: events.Resize) -> None:
        """Where there is room, both."""
        self._below.display = event.size.height >= self.BOTH_FROM_ROWS

    def show_way(self, way: Way | None) -> None:
        """This program's way, or more of it."""
        if way is not self.scene.way:
            self.scene.way = way
            self._each(PathPane.load)

    def forget(self) -> None:
        """Another program: nothing is known of it yet, and nothing of it was made."""
        scene = self.scene
        scene.way, scene.first, scene.last, scene.move = None, 0, 0, 0
        self._each(PathPane.load)

    def show_box(self, low: Spot, high: Spot) -> None:
        """The travel; drawn anew where it is another one."""
        if self.scene.box != (low, high):
            self.scene.box = low, high
            self._each(PathPane.load)

    def hide_box(self) -> None:
        """Nobody knows where the travel ends."""
        if self.scene.box is not None:
            self.scene.box = None
            self._each(PathPane.draw_all)

    def show_place(self, tool: Spot, zero: Spot, move: int, *, running: bool) -> None:
        """Where the tool is, and in which move of the program.

        Args:
            tool: machine mm.
            zero: where the work zero lies.
            move: in hand; 0: none.
            running: the program runs; else what was done stays as it is.
        """
        scene = self.scene
        scene.tool, scene.zero = tool, zero
        scene.move = move if running else 0
        if scene.move:
            if not scene.first or move < scene.last:
                scene.first = move
            scene.last = move
        self._each(PathPane.follow)

    def next_side(self) -> None:
        """From another side: XY, from a corner, XZ, YZ."""
        side = SIDES[(SIDES.index(self._main.side) + 1) % len(SIDES)]
        self._main.look_from(side)
        self._below.look_from(XY if side in (XZ, SIDES[3]) else XZ)

    def fit(self) -> None:
        """All is seen."""
        self._each(PathPane.fit)

    def zoom(self, steps: int) -> None:
        """Nearer, or further away."""
        self._main.zoom(steps)

    def pan(self, right: int, down: int) -> None:
        """Look elsewhere, in steps of a sixth of what is seen."""
        size: Size = self._main.size
        self._main.pan(right * max(1, size.width // 6), down * max(1, size.height // 6))

    def _each(self, action: Any) -> None:
        for pane in self.panes:
            if pane.display:
                action(pane)
