"""How many ticks were later than so much: both axes logarithmic, one curve a row.

One tick in a hundred thousand is seen as well as all the others; whoever is further to the left is
more punctual.
"""

import math

import numpy as np

from bench.timing.figures import Row, Section

_WIDTH, _HEIGHT = 720, 320
_LEFT, _RIGHT, _TOP, _BOTTOM = 78, 30, 52, 44
#: Names of the curves stand side by side above the picture, so far apart.
_LEGEND = 200
_COLOURS = ("#1f5fa8", "#c8502d", "#3c8c4a", "#7a4f9a")
_FROM_US, _TO_US = 1e-2, 1e5
_LEAST = 1e-6
_POINTS = 160


def svg(section: Section) -> str:
    """The picture of a section; it must have rows."""
    interval_us = section.rows[0].interval_us
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {_HEIGHT}" '
        'font-family="sans-serif" font-size="12" fill="#333">',
        f'<rect width="{_WIDTH}" height="{_HEIGHT}" fill="#fff"/>',
        _text(_LEFT, 20, section.title, 'font-weight="bold"'),
        _text(_WIDTH - _RIGHT, _HEIGHT - 8, "later than, us", 'text-anchor="end"'),
        _text(
            16, _TOP, "share of the ticks", f'text-anchor="end" transform="rotate(-90 16 {_TOP})"'
        ),
        *_grid(),
        _line([(interval_us / 4, 1.0), (interval_us / 4, _LEAST)], "#999", 1.2, "5 3"),
        _text(_x(interval_us / 4) - 4, _HEIGHT - _BOTTOM - 6, "a quarter", 'text-anchor="end"'),
    ]
    for k, row in enumerate(section.rows):
        colour = _COLOURS[k % len(_COLOURS)]
        parts.append(_line(_curve(row), colour, 1.6))
        parts.append(_text(_LEFT + _LEGEND * k, 40, row.name, f'fill="{colour}"'))
    return "\n".join([*parts, "</svg>", ""])


def _curve(row: Row) -> list[tuple[float, float]]:
    """Share of the ticks that were later than each of some times."""
    late_us = np.sort(row.late_us)
    at_us = np.geomspace(_FROM_US, _TO_US, _POINTS)
    later = len(late_us) - np.searchsorted(late_us, at_us, side="right")
    points = [(float(us), float(n) / len(late_us)) for us, n in zip(at_us, later, strict=True) if n]
    # Down to the axis at the longest: the last step of the curve is one tick.
    return [*points, (max(float(late_us[-1]), _FROM_US), _LEAST)]


def _grid() -> list[str]:
    parts = []
    for power in range(round(math.log10(_FROM_US)), round(math.log10(_TO_US)) + 1):
        parts.append(_line([(10.0**power, 1.0), (10.0**power, _LEAST)], "#e4e4e4"))
        label = f"{10.0**power:g}" if power < 5 else "100 000"
        parts.append(_text(_x(10.0**power), _HEIGHT - _BOTTOM + 16, label, 'text-anchor="middle"'))
    for power in range(round(math.log10(_LEAST)), 1):
        parts.append(_line([(_FROM_US, 10.0**power), (_TO_US, 10.0**power)], "#e4e4e4"))
        label = "all" if not power else f"1 in 10{_superscript(-power)}"
        parts.append(_text(_LEFT - 6, _y(10.0**power) + 4, label, 'text-anchor="end"'))
    return parts


def _superscript(number: int) -> str:
    return str(number).translate(str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹"))


def _x(us: float) -> float:
    share = math.log(us / _FROM_US) / math.log(_TO_US / _FROM_US)
    return _LEFT + min(max(share, 0.0), 1.0) * (_WIDTH - _LEFT - _RIGHT)


def _y(share: float) -> float:
    up = math.log(max(share, _LEAST) / _LEAST) / math.log(1 / _LEAST)
    return _HEIGHT - _BOTTOM - up * (_HEIGHT - _TOP - _BOTTOM)


def _text(x: float, y: float, words: str, more: str = "") -> str:
    return f'<text x="{x:.0f}" y="{y:.0f}" {more}>{words}</text>'


def _line(
    points: list[tuple[float, float]], colour: str, width: float = 1, dashes: str = ""
) -> str:
    at = " ".join(f"{_x(us):.1f},{_y(share):.1f}" for us, share in points)
    dashed = f' stroke-dasharray="{dashes}"' if dashes else ""
    return f'<polyline points="{at}" fill="none" stroke="{colour}" stroke-width="{width}"{dashed}/>'
