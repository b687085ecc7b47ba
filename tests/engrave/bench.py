"""Where drawings are made, engraved, and looked at as the machine would see them."""

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from typer.testing import CliRunner, Result

from fraese.cli import app

SQUARE_SVG = """<svg xmlns="http://www.w3.org/2000/svg"
 width="40mm" height="30mm" viewBox="0 0 40 30">
<rect x="5" y="5" width="30" height="20" fill="none" stroke="black"/>
<circle cx="20" cy="10" r="4"/>
</svg>"""
SQUARE_HPGL = "IN;SP1;PU0,0;PD1200,0,1200,800,0,800,0,0;PU600,400;CI160;SP0;"


@dataclass(frozen=True)
class Way:
    """A move as the interpreter of programs sees it; power 0: dark."""

    kind: str
    begin: tuple[float, float, float]
    end: tuple[float, float, float]
    power: float
    length_mm: float


class Bench:
    """A folder, and the commands one types there."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def file(self, name: str, text: str | bytes) -> Path:
        path = self.folder / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    def run(self, *words: object) -> Result:
        result = CliRunner().invoke(app, [*map(str, words)])
        assert result.exception is None or isinstance(result.exception, SystemExit), result
        assert "Traceback" not in result.output
        return result

    def engrave(self, file: Path, *words: object) -> dict[str, Any]:
        """What the command says of a program that it made: ``out.ngc``."""
        out = self.folder / "out.ngc"
        result = self.run("engrave", file, "-o", out, "--force", "--json", *words)
        assert result.exit_code == 0, result.output
        values: dict[str, Any] = json.loads(result.stdout.splitlines()[-1])
        return values

    def refused(self, *words: object) -> str:
        """The one sentence with which it is refused."""
        result = self.run("engrave", *words)
        assert result.exit_code == 2, result.output
        lines = result.stderr.splitlines()
        assert len(lines) == 1, result.stderr
        return lines[0]

    @property
    def text(self) -> str:
        return (self.folder / "out.ngc").read_text("ascii")

    def ways(self) -> list[Way]:
        """The moves of the program, by the interpreter that runs it."""
        shown = self.run("gcode", self.folder / "out.ngc")
        assert shown.exit_code == 0, shown.output
        at, power, found = (0.0, 0.0, 0.0), 0.0, []
        for line in shown.stdout.splitlines():
            move = json.loads(line)
            if move["kind"] == "spindle":
                power = move["rev_min"] if move["direction"] else 0.0
            if "to" not in move:
                continue
            to = tuple(move["to"])
            length = math.dist(at, to)
            if move["kind"] == "arc":
                length = arc_length_mm(at, to, move["centre"], move["turns"])
            lit = 0.0 if move["kind"] == "rapid" else power
            found.append(Way(move["kind"], at, to, lit, length))
            at = to
        return found

    def cut(self, ways: list[Way]) -> list[Way]:
        """Moves below the surface, sideways."""
        return [w for w in ways if w.end[2] < 0 and w.kind != "rapid" and w.length_mm > 0
                and (w.kind == "arc" or w.begin[:2] != w.end[:2])]  # fmt: skip


def arc_length_mm(
    begin: tuple[float, ...], end: tuple[float, ...], centre: list[float], turns: int
) -> float:
    first = math.atan2(begin[1] - centre[1], begin[0] - centre[0])
    last = math.atan2(end[1] - centre[1], end[0] - centre[0])
    swept = (last - first) * (1 if turns > 0 else -1) % math.tau
    if math.dist(begin[:2], end[:2]) < 1e-9:
        swept = math.tau
    return math.dist(begin[:2], centre) * swept
