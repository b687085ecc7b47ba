"""The bench in characters: lamps, currents as bars, dials, and the lines as they were played.

    data 29  D7 ○ D6 ○ D5 ● D4 ○ D3 ● D2 ○ D1 ○ D0 ●
    A      ███│        -60        bars to either side of nothing
    D0 ▁▁▁│▔▔▔│▁▁▁▁▒▒▔▔           low, an edge, high, more edges than can be seen

Nothing depends on colour: a lamp that is on is full.
"""

from collections.abc import Mapping, Sequence
from typing import Final

from fraese.control.benchfacts import Access, BenchFacts, MotorFacts
from fraese.phrases import spoken

_ON, _OFF = "●", "○"
_LOW, _HIGH, _EDGE, _MANY = "▁", "▔", "│", "▒"
#: Arrows in eight directions, a half-step apart, counter-clockwise from the right.
_ARROWS: Final = tuple(map(chr, (0x2192, 0x2197, 0x2191, 0x2196, 0x2190, 0x2199, 0x2193, 0x2198)))
#: Where they lie on a dial of five rows, likewise: (row, column).
_PLACES: Final = ((2, 8), (1, 7), (0, 4), (1, 1), (2, 0), (3, 1), (4, 4), (3, 7))
_DATA, _CONTROL = 0, 2
_BITS: Final = 8
_FULL_PERCENT: Final = 100


def lamps(facts: BenchFacts) -> str:
    """The data byte, a lamp a bit."""
    bits = "  ".join(
        f"D{bit} {_ON if facts.data >> bit & 1 else _OFF}" for bit in range(_BITS - 1, -1, -1)
    )
    worked_out = "" if facts.is_seen else spoken("  (worked out)")
    return spoken(
        "data {data:02X}   {bits}{worked_out}", data=facts.data, bits=bits, worked_out=worked_out
    )


def pins(name: str, levels: Mapping[int, bool]) -> str:
    """Lines by their pin, a lamp each."""
    return f"{name} " + "  ".join(
        f"{pin} {_ON if high else _OFF}" for pin, high in sorted(levels.items())
    )


def bar(percent: int, half: int) -> str:
    """A signed bar: nothing in the middle."""
    length = round(abs(percent) / _FULL_PERCENT * half)
    if percent < 0:
        return ("█" * length).rjust(half) + "│" + " " * half
    return " " * half + "│" + ("█" * length).ljust(half)


def arrow(part: float | None) -> str:
    """Where it points, in parts of a turn."""
    return "·" if part is None else _ARROWS[round(part * len(_ARROWS)) % len(_ARROWS)]


def motor_line(motor: MotorFacts, entries: int, chosen: bool, width: int) -> str:
    """A motor in one row."""
    half = max(3, (width - 52) // 4)
    phase = f"{motor.phase:>2}/{entries}" if entries else "  -"
    byte = "--" if motor.latched is None else f"{motor.latched:02X}"
    rotor = "" if motor.rotor is None else spoken(" rotor {arrow}", arrow=arrow(motor.rotor))
    held = spoken(" HELD") if motor.is_blocked else ""
    return spoken(
        "{what} {name} {phase} {byte}  A{a_percent:+4d} {bar}  B{b_percent:+4d} {bar_2}"
        "  field {arrow}{rotor}{held}",
        what="▶" if chosen else " ",
        name=motor.name.upper(),
        phase=phase,
        byte=byte,
        a_percent=motor.a_percent,
        bar=bar(motor.a_percent, half),
        b_percent=motor.b_percent,
        bar_2=bar(motor.b_percent, half),
        arrow=arrow(motor.field),
        rotor=rotor,
        held=held,
    )


def table_line(facts: BenchFacts, motor: MotorFacts) -> str:
    """The phase table, the motor's row in brackets."""
    if not facts.table:
        return spoken("The drives have phase tables of their own.")
    rows = " ".join(
        f"[{n}:{byte:02X}]" if n == motor.phase else f" {n}:{byte:02X} "
        for n, byte in enumerate(facts.table)
    )
    return spoken("table {table_name}  {rows}", table_name=facts.table_name, rows=rows)


def dial(motor: MotorFacts) -> list[str]:
    """Five rows: the field an empty circle, the rotor a full one, both the same a target."""
    field = None if motor.field is None else round(motor.field * len(_PLACES)) % len(_PLACES)
    rotor = None if motor.rotor is None else round(motor.rotor * len(_PLACES)) % len(_PLACES)
    picture = [[" "] * 9 for _ in range(5)]
    picture[2][4] = "+"
    for n, (row, column) in enumerate(_PLACES):
        sign = "·"
        if n == field:
            sign = "◎" if n == rotor else "○"
        elif n == rotor:
            sign = "●"
        picture[row][column] = sign
    return ["".join(row) for row in picture]


def dials(motors: Sequence[MotorFacts]) -> list[str]:
    """All side by side, with their names."""
    pictures = [dial(motor) for motor in motors]
    head = "     ".join(f"    {motor.name.upper()}    " for motor in motors)
    rows = ["     ".join(picture[row] for picture in pictures) for row in range(5)]
    return [head, *rows, spoken("○ field   ● rotor   ◎ both")]


def waves(heard: Sequence[Access], width: int, rows: int) -> list[str]:
    """The latest accesses, a row a line: the data bits, and the strobe or clock below them.

    Args:
        heard: from the first to the last.
        width: of all.
        rows: that there is room for.
    """
    if not heard:
        return [spoken("Nothing was played yet since this view is open.")]
    columns = max(10, width - 5)
    shown = heard[-4 * columns :]
    first, last = shown[0].at_ns, shown[-1].at_ns
    span = max(1, last - first)
    lines = [("D" + str(bit), _DATA, bit) for bit in range(_BITS - 1, -1, -1)]
    lines.append(("STR", _CONTROL, 0))
    drawn = [
        f"{name:<4}{_wave(shown, register, bit, first, span, columns)}"
        for name, register, bit in lines[: max(1, rows - 1)]
    ]
    if rows > 2 * len(drawn):
        # Where there is room, lines that lie high and low do not touch.
        drawn = [row for line in drawn for row in (line, "")]
    return [
        *drawn,
        spoken(
            "{what:4}{count} accesses in {span:.3f} ms",
            what="",
            count=len(shown),
            span=span / 1000000.0,
        ),
    ]


def _wave(
    heard: Sequence[Access], register: int, bit: int, first: int, span: int, columns: int
) -> str:
    """One line: what it is at the end of each column, and where it changed."""
    edges, levels = [0] * columns, [-1] * columns
    level = 0
    known = False
    for access in heard:
        if access.register != register:
            continue
        at = min(columns - 1, (access.at_ns - first) * columns // span)
        new = access.value >> bit & 1
        edges[at] += known and new != level
        level, known = new, True
        levels[at] = new
    drawn, now = [], max(0, next((each for each in levels if each >= 0), 0))
    for count, after in zip(edges, levels, strict=True):
        now = after if after >= 0 else now
        drawn.append(_MANY if count > 1 else _EDGE if count else (_HIGH if now else _LOW))
    return "".join(drawn)
