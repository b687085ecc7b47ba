"""Short ways to run a program in a test."""

from collections.abc import Generator
from pathlib import Path
from typing import Any

from fraese.gcode.canon import Breath, Facts, Move, Offsets
from fraese.gcode.coordlist import read_points
from fraese.gcode.interpreter import Interpreter, interpret
from fraese.gcode.reader import kind_of
from fraese.gcode.setup import Setup
from fraese.gcode.text import read_lines


def moves(text: str, **setup: Any) -> list[Move]:
    """All moves of a program whose lines are divided by ``|`` or line ends; no word of offsets."""
    return [move for move in marked(text, **setup) if not isinstance(move, Offsets | Breath)]


def marked(text: str, **setup: Any) -> list[Move]:
    """The same, and where offsets change."""
    return list(interpret(_lines(text), Setup(**setup)))


def answered(text: str, *answers: Facts | None, **setup: Any) -> tuple[list[Move], Interpreter]:
    """All moves but the words of offsets, with answers to its barriers in turn."""
    interpreter = Interpreter(Setup(**setup))
    run = interpreter.run(_lines(text))
    left = list(answers)
    result: list[Move] = []
    answer = None
    try:
        while True:
            move = run.send(answer)
            if not isinstance(move, Offsets):
                result.append(move)
            answer = None
            if type(move).__name__ in ("Probe", "Tool", "Pause") and left:
                answer = left.pop(0)
    except StopIteration:
        return result, interpreter


def _lines(text: str) -> list[str]:
    return text.replace("|", "\n").splitlines()


def read_moves(
    path: Path,
    setup: Setup,
    feed_mm_min: float = 0.0,
) -> Generator[Move, Facts | None, None]:
    """All moves of a file, program or list; barriers want an answer."""
    lines = read_lines(path, setup.file)
    if kind_of(path) == "gcode":
        yield from Interpreter(setup).run(lines)
    else:
        yield from read_points(lines, setup, "mm", feed_mm_min)
