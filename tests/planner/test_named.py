"""Blocks and segments are filled by name: with keywords, or on the hot path with namesakes."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

import fraese
from fraese.blocks import Block
from fraese.planner.segments import Segment

FIELDS = {"Block": Block._fields, "Segment": Segment._fields}
#: Other things have these names too: a piece of a terminal's line, a line of a program.
NOT_OURS = ("ui", "gcode")
ROOT = Path(fraese.__file__).parent


def calls() -> Iterator[tuple[str, ast.Call]]:
    for path in sorted(ROOT.rglob("*.py")):
        where = path.relative_to(ROOT)
        if where.parts[0] not in NOT_OURS:
            for node in ast.walk(ast.parse(path.read_text("utf-8"))):
                if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                    yield f"{where}:{node.lineno}", node


@pytest.mark.parametrize("kind", FIELDS)
def test_every_value_bears_the_name_of_its_field(kind: str) -> None:
    found = 0
    for place, call in calls():
        assert isinstance(call.func, ast.Name)
        if call.func.id == kind:
            assert not call.args, f"{place}: name the fields"
            found += 1
        elif call.func.id == "_new" and ast.unparse(call.args[0]) == kind:
            values = call.args[1]
            assert isinstance(values, ast.Tuple)
            assert tuple(ast.unparse(value) for value in values.elts) == FIELDS[kind], place
            found += 1
    assert found >= 2
