"""A stretch as a picture (SVG), for a page or a report. Written by hand: it is a few paths."""

import math
from collections.abc import Iterator, Sequence
from typing import Final
from xml.sax.saxutils import escape

from fraese.waves import times
from fraese.waves.figures import QuantityFigures
from fraese.waves.stretch import Seen, Stretch

#: Columns of a picture, one pixel each.
WIDTH_PX: Final = 1200
_LABEL_PX: Final = 190
_ROW_PX: Final = 34
_WAVE_PX: Final = 20
_TOP_PX: Final = 34
_EDGE_PX: Final = 16
_TICKS: Final = 10
_STYLE: Final = (
    "text{font:13px sans-serif;fill:#222}.t{fill:#666;font-size:11px}"
    ".w{fill:none;stroke:#0b5d8a;stroke-width:1.4}.m{fill:#0b5d8a;fill-opacity:.45}"
    ".g{stroke:#ddd}.x{stroke:#b33;stroke-dasharray:3 3}"
)


def picture(stretch: Stretch, shown: Sequence[Seen]) -> str:
    """The whole file."""
    height = _TOP_PX + _ROW_PX * len(shown) + _EDGE_PX
    width = _LABEL_PX + stretch.width + _EDGE_PX
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}"'
        f' viewBox="0 0 {width} {height}">',
        f"<style>{_STYLE}</style>",
        f'<rect width="{width}" height="{height}" fill="#fff"/>',
        *_grid(stretch, height),
    ]
    for number, seen in enumerate(shown):
        low_px = _TOP_PX + _ROW_PX * number + _ROW_PX - (_ROW_PX - _WAVE_PX) // 2
        parts.append(f'<text x="8" y="{low_px - 5}">{escape(seen.line.name)}</text>')
        parts += _wave(seen, low_px)
    return "\n".join([*parts, "</svg>", ""])


def _grid(stretch: Stretch, height: int) -> Iterator[str]:
    """Moments from left to right."""
    begin_s = stretch.start * stretch.file.unit_s
    tick_s = times.tick_s(stretch.span_s, _TICKS)
    number = math.ceil(begin_s / tick_s - 1e-9)
    while (along := (number * tick_s - begin_s) / stretch.span_s) <= 1:
        x = _LABEL_PX + along * stretch.width
        word = times.tick_word(number, tick_s, stretch.end * stretch.file.unit_s)
        yield f'<line class="g" x1="{x:.1f}" x2="{x:.1f}" y1="{_TOP_PX - 8}" y2="{height}"/>'
        yield f'<text class="t" x="{x:.1f}" y="{_TOP_PX - 14}" text-anchor="middle">{word}</text>'
        number += 1


def _wave(seen: Seen, low_px: int) -> Iterator[str]:
    """A line as a path, and a block wherever edges are too many to be seen."""
    figures, columns = seen.figures, seen.columns
    least, most = 0.0, 1.0
    if isinstance(figures, QuantityFigures):
        least, most = figures.least, figures.most

    def y(value: float) -> float:
        part = (value - least) / (most - least) if most > least else 0.0
        return low_px - part * _WAVE_PX

    path, dense, before = [], [], columns.level
    for place, (edges, end) in enumerate(
        zip(columns.edges.tolist(), columns.ends.tolist(), strict=True)
    ):
        x = _LABEL_PX + place
        if edges > 1:
            dense.append(f"M{x} {low_px - _WAVE_PX}h1v{_WAVE_PX}h-1z")
        if math.isnan(end):
            before = end
            continue
        if math.isnan(before) or not place:
            path.append(f"M{x} {y(end if math.isnan(before) else before):.1f}")
        if edges:
            path.append(f"H{x}V{y(end):.1f}")
        before = end
    if not math.isnan(before):
        path.append(f"H{_LABEL_PX + len(columns.ends)}")
    if dense:
        yield f'<path class="m" d="{"".join(dense)}"/>'
    if path:
        yield f'<path class="w" d="{"".join(path)}"/>'
    else:
        yield (
            f'<line class="x" x1="{_LABEL_PX}" x2="{_LABEL_PX + len(columns.ends)}"'
            f' y1="{low_px - _WAVE_PX // 2}" y2="{low_px - _WAVE_PX // 2}"/>'
        )
