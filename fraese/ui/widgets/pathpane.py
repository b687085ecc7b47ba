r"""The toolpath, drawn: where it goes, what is done, where the tool is.

    scene (what there is)  --->  pane (from one side): layers of dots ---> strips
       \--- outline, progress, tool, work zero, travel

Rule 1: a picture is drawn in pieces of a few milliseconds, into a field of its own that is shown
        when it is whole: the app hears every key meanwhile.
Rule 2: progress draws what has been done since, and only rows that changed are shown again.
Rule 3: colour is never the only sign: rapids, the way to come and the way made are told apart by
        the element in hand and by the tool, which have characters of their own.
"""

import os
import time
from typing import Any, Final

import numpy as np
from rich.segment import Segment
from rich.style import Style
from textual import events
from textual.geometry import Offset, Region
from textual.strip import Strip
from textual.widget import Widget

from fraese.dots import BRAILLE, HALVES, Cell, Dots
from fraese.phrases import spoken
from fraese.ui.widgets.projection import (
    Projection,
    Side,
    box_edges,
    round_length_mm,
)
from fraese.ui.widgets.scene import Scene

#: Layers, the lowest first, and the class that each is drawn with.
_FRAME, _RAPID, _TODO, _DONE, _NOW = range(5)
_CLASSES: Final = ("frame", "rapid", "todo", "done", "now")
#: Lines that are drawn at once; so long the app waits at most.
_CHUNK: Final = 8192
_BUDGET_S: Final = 0.006
_PAUSE_S: Final = 0.002
_TOOL: Final = "◆"
_ZERO: Final = "⊕"
_ZOOM_STEP: Final = 1.5
#: The text console has no braille.
_WITHOUT_BRAILLE: Final = ("linux", "vt100", "vt220", "dumb")


def cell_of_terminal() -> Cell:
    """Braille where it is to be had."""
    return HALVES if os.environ.get("TERM", "") in _WITHOUT_BRAILLE else BRAILLE


class PathPane(Widget):
    """The scene from one side; dragged with the mouse, zoomed with its wheel.

    Args:
        scene: what there is.
        side: from where.
        cell: how dots lie in a character.
    """

    COMPONENT_CLASSES = {f"toolpath--{name}" for name in (*_CLASSES, "tool", "zero", "caption")}  # noqa: RUF012

    def __init__(self, scene: Scene, side: Side, cell: Cell | None = None, **options: Any) -> None:
        super().__init__(**options)
        self._scene = scene
        self._cell = cell or cell_of_terminal()
        self._view = Projection(side, 1, 1)
        self._moved = False
        self._shown = Dots(1, 1, len(_CLASSES), self._cell)
        self._strips: list[Strip | None] = []
        self._fresh: Dots | None = None
        self._next = 0
        self._again = False
        # Lines up to here are in the layer of what is done; and rows with the element in hand.
        self._done = 1
        self._lit: set[int] = set()
        self._marks: dict[tuple[int, int], str] = {}
        self._followed: object = None
        self._dragged: Offset | None = None

    @property
    def side(self) -> Side:
        """From where it is looked at."""
        return self._view.side

    @property
    def is_drawing(self) -> bool:
        """The picture is not whole yet."""
        return self._fresh is not None or self._again

    # --- what is wanted --------------------------------------------------------------------------

    def look_from(self, side: Side) -> None:
        """From this side, all of it."""
        self._view = Projection(side, self._view.columns, self._view.rows)
        self.fit()

    def fit(self) -> None:
        """All is seen."""
        self._moved = False
        scene = self._scene
        way = scene.way.points if scene.way is not None else np.zeros((0, 3))
        if len(way) < 2:
            way = np.array(scene.box or [(0, 0, 0), (1, 1, 1)])
        self._view = self._view.fitted(way)
        self.draw_all()

    def zoom(self, steps: int, at: Offset | None = None) -> None:
        """Nearer, or (negative) further away; round a cell, or the middle."""
        cell = self._cell
        dot = (None, None) if at is None else ((at.x + 0.5) * cell.wide, (at.y + 0.5) * cell.high)
        self._moved = True
        self._view = self._view.zoomed(_ZOOM_STEP**steps, *dot)
        self.draw_all()

    def pan(self, right: int, down: int) -> None:
        """Look so many cells further to the right and down."""
        self._moved = True
        self._view = self._view.panned(right * self._cell.wide, down * self._cell.high)
        self.draw_all()

    def load(self) -> None:
        """Another way, or more of it."""
        if self._moved:
            self.draw_all()
        else:
            self.fit()

    # --- drawing ---------------------------------------------------------------------------------

    def on_resize(self, event: events.Resize) -> None:
        """A field of another size."""
        width, height = max(1, event.size.width), max(1, event.size.height)
        columns, rows = width * self._cell.wide, height * self._cell.high
        before, self._view = (
            self._view,
            Projection(
                self.side, columns, rows, self._view.centre, self._view.per_mm, self._view.zoom
            ),
        )
        if (before.columns, before.rows) != (columns, rows):
            self._shown = Dots(width, height, len(_CLASSES), self._cell)
            self._strips = [None] * height
            self.load()

    def draw_all(self) -> None:
        """A whole picture; one that is being drawn is finished first."""
        if self._fresh is not None:
            self._again = True
            return
        self._again = False
        self._followed = None
        self._fresh = fresh = Dots(self._shown.width, self._shown.height, len(_CLASSES), self._cell)
        if self._scene.box is not None:
            edges = self._view.dots(box_edges(*self._scene.box)).reshape(-1, 2, 2)
            fresh.lines(_FRAME, edges[:, 0], edges[:, 1])
        self._next = 1
        self._done = self._scene.done()[1]
        self._draw_some(self._view)

    def _draw_some(self, view: Projection) -> None:
        fresh, way = self._fresh, self._scene.way
        if fresh is None:
            return
        until_s = time.monotonic() + _BUDGET_S
        count = 0 if way is None else len(way.moves)
        while self._next < count and time.monotonic() < until_s:
            end = min(count, self._next + _CHUNK)
            self._draw_lines(fresh, view, self._next, end)
            self._next = end
        if self._next < count and self.is_attached:
            self.set_timer(_PAUSE_S, lambda: self._draw_some(view))
            return
        self._fresh = None
        if (fresh.width, fresh.height) == (self._shown.width, self._shown.height):
            self._shown = fresh
            self._strips = [None] * fresh.height
            self._lit.clear()
            self._followed = None
            self.follow()
            self.refresh()
        if self._again:
            self.draw_all()

    def _draw_lines(self, onto: Dots, view: Projection, start: int, end: int) -> None:
        way = self._scene.way
        assert way is not None
        dots = view.dots(way.points[start - 1 : end])
        begin, to, rapid = dots[:-1], dots[1:], way.rapid[start:end]
        onto.lines(_RAPID, begin[rapid], to[rapid])
        first, done = self._scene.done()[0], self._done
        numbers = np.arange(start, end)
        made = ~rapid & (numbers >= first) & (numbers < done)
        onto.lines(_TODO, begin[~rapid & ~made], to[~rapid & ~made])
        onto.lines(_DONE, begin[made], to[made])

    def follow(self) -> None:
        """The job has gone on, or the tool has moved; if neither has, nothing is drawn."""
        scene = self._scene
        followed = (scene.tool, scene.zero, scene.first, scene.last, scene.move)
        if followed == self._followed:
            return
        self._followed = followed
        rows = self._lit
        self._lit = set()
        if self._fresh is None:
            rows |= self._follow_done()
        for row in rows:
            self._shown.dots[_NOW, row * self._cell.high : (row + 1) * self._cell.high] = False
        self._lit = self._light()
        rows = rows | self._lit
        marks = self._marked()
        if marks != self._marks:
            rows |= {row for _, row in (*marks, *self._marks)}
            self._marks = marks
        for row in rows:
            if row < len(self._strips):
                self._strips[row] = None
                self.refresh(Region(0, row, self.size.width, 1))

    def _follow_done(self) -> set[int]:
        first, done = self._scene.done()
        before, self._done = self._done, done
        if done < before:
            self.draw_all()
            return set()
        start = max(first, before)
        if start >= done:
            return set()
        if done - start > _CHUNK:
            self.draw_all()
            return set()
        return self._lines(_DONE, start, done)

    def _light(self) -> set[int]:
        """The element in hand."""
        start, end = self._scene.span(self._scene.move) if self._scene.move else (1, 1)
        return self._lines(_NOW, start, min(end, start + _CHUNK), rapids=True)

    def _lines(self, layer: int, start: int, end: int, *, rapids: bool = False) -> set[int]:
        way = self._scene.way
        if way is None or start >= end:
            return set()
        dots = self._view.dots(way.points[start - 1 : end])
        wanted = np.ones(end - start, np.bool_) if rapids else ~way.rapid[start:end]
        return set(self._shown.lines(layer, dots[:-1][wanted], dots[1:][wanted]).tolist())

    def _marked(self) -> dict[tuple[int, int], str]:
        """Cells with a character of their own."""
        marks = {}
        for spot, sign in ((self._scene.zero, _ZERO), (self._scene.tool, _TOOL)):
            if spot is not None:
                column, row = self._view.dots(spot)[0]
                cell = int(column // self._cell.wide), int(row // self._cell.high)
                if 0 <= cell[0] < self._shown.width and 0 <= cell[1] < self._shown.height:
                    marks[cell] = sign
        return marks

    # --- on the screen ---------------------------------------------------------------------------

    def render_line(self, y: int) -> Strip:
        """One row."""
        if y >= len(self._strips):
            return Strip.blank(self.size.width, self.rich_style)
        strip = self._strips[y]
        if strip is None:
            strip = self._strips[y] = self._strip(y)
        return strip

    def notify_style_update(self) -> None:
        """Other colours."""
        self._strips = [None] * len(self._strips)
        super().notify_style_update()

    def _strip(self, y: int) -> Strip:
        numbers, layers = self._shown.row(y)
        characters = [self._cell.characters[n] for n in numbers.tolist()]
        kinds: list[str] = [_CLASSES[n] if n >= 0 else "" for n in layers.tolist()]
        for (column, row), sign in self._marks.items():
            if row == y:
                characters[column] = sign
                kinds[column] = "tool" if sign == _TOOL else "zero"
        self._write_caption(y, characters, kinds)
        styles: dict[str, Style] = {"": self.rich_style}
        segments, begin = [], 0
        for at in range(1, len(kinds) + 1):
            if at == len(kinds) or kinds[at] != kinds[begin]:
                kind = kinds[begin]
                if kind not in styles:
                    styles[kind] = self.get_component_rich_style(f"toolpath--{kind}")
                segments.append(Segment("".join(characters[begin:at]), styles[kind]))
                begin = at
        return Strip(segments, len(kinds))

    def _write_caption(self, y: int, characters: list[str], kinds: list[str]) -> None:
        width = len(characters)
        texts = []
        if y == 0:
            texts.append((0, self.side.name))
        if y == self._shown.height - 1 and width >= 30:
            scale = self._view.dots_per_mm / self._cell.wide
            length_mm = round_length_mm(scale, width / 5)
            bar = "─" * max(0, round(length_mm * scale) - 2)
            text = spoken("├{bar}┤ {length_mm:g} mm", bar=bar, length_mm=length_mm)
            texts.append((width - len(text), text))
        for at, text in texts:
            for column, character in enumerate(text, at):
                if 0 <= column < width:
                    characters[column], kinds[column] = character, "caption"

    # --- the mouse -------------------------------------------------------------------------------

    def on_mouse_scroll_up(self, event: events.MouseScrollUp) -> None:
        """Nearer."""
        event.stop()
        self.zoom(1, event.offset)

    def on_mouse_scroll_down(self, event: events.MouseScrollDown) -> None:
        """Further away."""
        event.stop()
        self.zoom(-1, event.offset)

    def on_mouse_down(self, event: events.MouseDown) -> None:
        """It is dragged from here."""
        self._dragged = event.screen_offset
        self.capture_mouse()

    def on_mouse_move(self, event: events.MouseMove) -> None:
        """Drag."""
        if self._dragged is not None:
            by = event.screen_offset - self._dragged
            if by:
                self._dragged = event.screen_offset
                self.pan(-by.x, -by.y)

    def on_mouse_up(self, event: events.MouseUp) -> None:
        """Let go."""
        self._dragged = None
        self.release_mouse()
