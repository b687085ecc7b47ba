"""The moves of a program as a picture: what is cut, how strongly, and the rapids between.

Rule 1: it is drawn from the moves as they are written, so it shows what the program does.
"""

import math
from typing import BinaryIO, Final

from PIL import Image, ImageDraw

from fraese.engrave.moves import RAPID, Move, way_of
from fraese.engrave.placing import Sheet

#: The longer side of what is drawn, pixels; a dot of a fine picture still is one.
_LONG_PX: Final = 800
_EDGE_PX: Final = 24
_PAPER, _RAPID, _ZERO, _FRAME = (255, 255, 255), (245, 150, 130), (40, 120, 220), (205, 205, 205)
_CHORD_PX: Final = 0.2


class Preview:
    """A picture that grows as moves pass.

    Args:
        sheet: where what is cut lies.
        overscan_mm: how far rows go beyond it.
        depth_mm: of a cutter; 0: it is a laser.
        power: of a laser, the greatest.
        line_mm: how wide a cut is drawn; a hair at least.
    """

    def __init__(
        self,
        sheet: Sheet,
        *,
        overscan_mm: float = 0.0,
        depth_mm: float = 0.0,
        power: float = 0.0,
        line_mm: float = 0.0,
    ) -> None:
        self._depth_mm, self._power = depth_mm, power
        low = [min(0.0, at) - overscan_mm for at in sheet.low]
        high = [
            max(0.0, at + size) + overscan_mm
            for at, size in zip(sheet.low, sheet.size, strict=True)
        ]
        wide, tall = (max(b - a, 1e-3) for a, b in zip(low, high, strict=True))
        self._per_mm = _LONG_PX / max(wide, tall)
        self._line_px = max(1, math.ceil(line_mm * self._per_mm))
        self._low = low
        size = [math.ceil(side * self._per_mm) + 2 * _EDGE_PX for side in (wide, tall)]
        self._top = size[1] - _EDGE_PX
        self._image = Image.new("RGB", (size[0], size[1]), _PAPER)
        self._draw = ImageDraw.Draw(self._image)
        self._at = (0.0, 0.0, 0.0)
        self._strength = 0.0
        self._mark(sheet)

    def _mark(self, sheet: Sheet) -> None:
        """The edge of the sheet, and zero."""
        x0, y0 = self._px(*sheet.low)
        x1, y1 = self._px(sheet.low[0] + sheet.size[0], sheet.low[1] + sheet.size[1])
        self._draw.rectangle((x0, y1, x1, y0), outline=_FRAME)
        x, y = self._px(0.0, 0.0)
        for dx, dy in ((14, 0), (0, 14)):
            self._draw.line((x - dx, y - dy, x + dx, y + dy), fill=_ZERO, width=2)

    def take(self, move: Move) -> None:
        """The next one."""
        x, y, z = self._at
        to = (x if move.x is None else move.x, y if move.y is None else move.y)
        if move.z is not None:
            z = move.z
        if move.power is not None:
            self._strength = move.power / self._power if self._power else 0.0
        line = [self._px(*at) for at in way_of(move, (x, y), to, _CHORD_PX / self._per_mm)]
        if move.cuts:
            strength = -z / self._depth_mm if self._depth_mm else self._strength
            grey = round(215 * (1 - min(max(strength, 0.05), 1.0)))
            self._draw.line(line, fill=(grey, grey, grey), width=self._line_px)
        elif move.kind == RAPID:
            self._draw.line(line, fill=_RAPID, width=1)
        elif z < 0 and to == (x, y):
            # A dot: the tool goes down, and nowhere else.
            px, py = line[0]
            half = max(1, self._line_px / 2)
            self._draw.ellipse((px - half, py - half, px + half, py + half), fill=(0, 0, 0))
        self._at = (*to, z)

    def _px(self, x: float, y: float) -> tuple[float, float]:
        return (
            _EDGE_PX + (x - self._low[0]) * self._per_mm,
            self._top - (y - self._low[1]) * self._per_mm,
        )

    def save(self, file: BinaryIO) -> None:
        """Write it as PNG.

        Raises:
            OSError: if it cannot be written.
        """
        few = self._image.quantize(32)
        few.save(file, "PNG", optimize=True)
