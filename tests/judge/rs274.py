"""What rs274 says about a program, as events in machine millimetres.

rs274 prints every canonical call in the unit of the program and in its coordinates, to four
decimals. So this reader follows the calls that set units and offsets, as the machine behind
the real interpreter does: an offset counts in the unit that is in force when it is set, a
position is then  rotate(printed + G92) + work offset + tool offset.

A line number of six digits leaves no blank before the call's name.

Without ``-t`` rs274 has a tool table of its own, with three tools and their lengths; here it is
always given one.

rs274 pretends an inch machine: its tool table and parameter file are in inches. Its probe
stops 0.01 inch short of the target. It has six axes; points are given for those that are asked
for.
"""

import math
import os
import re
import shutil
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

RS274 = shutil.which("rs274")
REASON = "rs274 is missing: apt-get install --no-install-recommends linuxcnc-uspace"

#: What stands in a call, in this order; U, V and W are none of its business.
LETTERS = "xyzabc"
Vector = tuple[float, ...]
ORIGIN: Vector = (0.0,) * len(LETTERS)
Event = tuple[object, ...]

_CALL = re.compile(r"^\s*\d+ N[\d.]*\s*([A-Z][A-Z_0-9]*)\((.*)\)$")
_PLANES = {"CANON_PLANE_XY": 17, "CANON_PLANE_XZ": 18, "CANON_PLANE_YZ": 19}
_AXES = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}
_MODES = {
    "CANON_EXACT_PATH": "G61",
    "CANON_EXACT_STOP": "G61.1",
    "CANON_CONTINUOUS": "G64",
}
INCH_MM = 25.4
# Where there is no table, every tool that a program may ask for, as in ours.
EVERY_TOOL = dict.fromkeys(range(1, 100), 0.0)
# A program that loops for ever is the judge's problem only as long as this.
TIMEOUT_S = 20.0


@dataclass
class Verdict:
    """Events in order, and the reason where the program was refused."""

    events: list[Event] = field(default_factory=list)
    refused: str = ""


def judge(
    text: str,
    folder: Path,
    tools: dict[int, float] | None = None,
    arguments: tuple[str, ...] = (),
    axes: str = "xyz",
    diameters: dict[int, float] | None = None,
) -> Verdict:
    """Run a program through rs274; tool lengths in mm, points for these axes.

    Args:
        text: the program.
        folder: for its files.
        tools: lengths; None: every tool has length 0, as where we are given no table.
        arguments: more for rs274.
        axes: of the machine.
        diameters: of tools of the table, mm.
    """
    assert RS274 is not None
    program = folder / "judged.ngc"
    program.write_bytes(text.encode("utf-8", "surrogateescape"))
    table = folder / "judged.tbl"
    table_of = EVERY_TOOL if tools is None else tools
    wide = diameters or {}
    lines = [
        f"T{n} P{n} Z{length / INCH_MM:.9f} D{wide.get(n, 0.0) / INCH_MM:.9f}"
        for n, length in table_of.items()
    ]
    table.write_text("".join(f"{line}\n" for line in lines))
    variables = folder / "judged.var"
    variables.write_text("5161 0\n")
    done = subprocess.run(
        [RS274, "-t", str(table), "-v", str(variables), *arguments, "-g", program.name],
        cwd=folder,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        timeout=TIMEOUT_S,
        # It shares its tool table by a file in the home folder: one for each judge.
        env={**os.environ, "HOME": str(folder)},
        check=False,
    )
    verdict = Verdict(list(_Listener(axes).listen(done.stdout.decode("latin-1"))))
    if done.returncode:
        said = done.stderr.decode("latin-1").splitlines()
        verdict.refused = " / ".join(said[1:]) or f"exit code {done.returncode}: {said}"
    return verdict


class _Listener:
    """Follows the canonical calls and says what they mean to the machine."""

    def __init__(self, axes: str) -> None:
        self._places = [LETTERS.index(letter) for letter in axes]
        self.unit_mm = 1.0
        self.work = self.g92 = self.tool = ORIGIN
        self.rotation = 0.0
        self.plane = 17
        self.feed = 0.0
        self.feed_unit_mm = 1.0
        self.at: Vector = ORIGIN
        self.direction = 0
        self.rev_min = 0.0
        self.mist = self.flood = False

    def listen(self, output: str) -> Iterator[Event]:
        for line in output.splitlines():
            match = _CALL.match(line)
            if match is None:
                yield "message", line.strip()
                continue
            name, arguments = match.groups()
            handler = getattr(self, f"on_{name.lower()}", None)
            if handler is not None:
                event = handler(arguments)
                if event is not None:
                    yield event

    def _numbers(self, arguments: str) -> list[float]:
        return [float(part) for part in re.split(r"[,\s]+", arguments) if part]

    def _all(self, printed: list[float]) -> Vector:
        x, y, *rest = (a + b for a, b in zip(self._scaled(printed), self.g92, strict=True))
        sine, cosine = math.sin(self.rotation), math.cos(self.rotation)
        turned = x * cosine - y * sine, x * sine + y * cosine, *rest
        return tuple(sum(parts) for parts in zip(turned, self.work, self.tool, strict=True))

    def _machine(self, printed: list[float]) -> Vector:
        every = self._all(printed)
        return tuple(every[place] for place in self._places)

    def _scaled(self, values: list[float]) -> Vector:
        """Lengths in mm, degrees as they are."""
        return tuple(
            value * (self.unit_mm if letter in "xyz" else 1.0)
            for letter, value in zip(LETTERS, values[: len(LETTERS)], strict=True)
        )

    # Frames

    def on_use_length_units(self, arguments: str) -> None:
        self.unit_mm = INCH_MM if "INCHES" in arguments else 1.0

    def on_set_g5x_offset(self, arguments: str) -> None:
        self.work = self._scaled(self._numbers(arguments)[1:])

    def on_set_g92_offset(self, arguments: str) -> None:
        self.g92 = self._scaled(self._numbers(arguments))

    def on_set_xy_rotation(self, arguments: str) -> None:
        self.rotation = math.radians(float(arguments))

    def on_use_tool_length_offset(self, arguments: str) -> None:
        self.tool = self._scaled(self._numbers(arguments))

    def on_select_plane(self, arguments: str) -> None:
        self.plane = _PLANES[arguments]

    def on_set_feed_rate(self, arguments: str) -> None:
        self.feed = float(arguments)
        self.feed_unit_mm = self.unit_mm

    # Motion

    def on_straight_traverse(self, arguments: str) -> Event:
        return "rapid", self._go(self._numbers(arguments))

    def on_straight_feed(self, arguments: str) -> Event:
        return self._fed("feed", self._numbers(arguments))

    def on_straight_probe(self, arguments: str) -> Event:
        return self._fed("probe", self._numbers(arguments))

    def _go(self, printed: list[float]) -> Vector:
        self.at = self._all(printed)
        return self._machine(printed)

    def _fed(self, kind: str, printed: list[float]) -> Event:
        """A feed is in degrees where nothing but rotary axes moves."""
        before = self.at
        to = self._go(printed)
        # Places are printed to four decimals, and offsets too.
        lengths = max(abs(a - b) for a, b in zip(before[:3], self.at[:3], strict=True))
        is_angle = lengths < 5e-3 and before[3:] != self.at[3:]
        return kind, to, self.feed * (1.0 if is_angle else self.feed_unit_mm)

    def on_arc_feed(self, arguments: str) -> Event:
        end1, end2, centre1, centre2, turns, end3, *rest = self._numbers(arguments)
        first, second, third = _AXES[self.plane]
        to = [0.0, 0.0, 0.0]
        to[first], to[second], to[third] = end1, end2, end3
        middle = [0.0, 0.0, 0.0]
        middle[first], middle[second] = centre1, centre2
        centre = self._all([*middle, *rest])
        return (
            "arc",
            self._go([*to, *rest]),
            (centre[first], centre[second]),
            self.plane,
            int(turns),
            self.feed * self.feed_unit_mm,
        )

    # The rest

    def on_dwell(self, arguments: str) -> Event:
        return "dwell", float(arguments)

    def on_set_spindle_speed(self, arguments: str) -> Event | None:
        self.rev_min = self._numbers(arguments)[1]
        return self._spindle(self.direction) if self.direction else None

    def on_start_spindle_clockwise(self, arguments: str) -> Event:
        return self._spindle(1)

    def on_start_spindle_counterclockwise(self, arguments: str) -> Event:
        return self._spindle(-1)

    def on_stop_spindle_turning(self, arguments: str) -> Event:
        return self._spindle(0)

    def _spindle(self, direction: int) -> Event:
        self.direction = direction
        return "spindle", direction, self.rev_min if direction else 0.0

    def on_mist_on(self, arguments: str) -> Event:
        self.mist = True
        return "coolant", self.mist, self.flood

    def on_mist_off(self, arguments: str) -> Event:
        self.mist = False
        return "coolant", self.mist, self.flood

    def on_flood_on(self, arguments: str) -> Event:
        self.flood = True
        return "coolant", self.mist, self.flood

    def on_flood_off(self, arguments: str) -> Event:
        self.flood = False
        return "coolant", self.mist, self.flood

    def on_change_tool(self, arguments: str) -> Event:
        return "tool", int(arguments)

    def on_program_stop(self, arguments: str) -> Event:
        return "pause", False

    def on_optional_program_stop(self, arguments: str) -> Event:
        return "pause", True

    def on_message(self, arguments: str) -> Event:
        return "message", arguments[1:-1].strip().replace("-0.0000", "0.0000")

    def on_enable_feed_override(self, arguments: str) -> Event:
        return "overrides", True

    def on_disable_feed_override(self, arguments: str) -> Event:
        return "overrides", False

    def on_set_motion_control_mode(self, arguments: str) -> Event:
        mode, *tolerance = arguments.split(", ")
        blend = _MODES[mode] == "G64"
        return "path", _MODES[mode], float(tolerance[0]) * self.unit_mm if blend else 0.0

    def on_program_end(self, arguments: str) -> Event:
        return ("end",)

    def on_finish(self, arguments: str) -> Event:
        return ("end",)
