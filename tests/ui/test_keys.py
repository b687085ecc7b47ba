"""The key table: the only place that names keys, for one to four axes of any name."""

import ast
import re
from collections.abc import Iterable
from pathlib import Path

import pytest

import fraese.ui
from fraese.ui.keyrows import GROUPS, Area, KeyTable, Row
from fraese.ui.keyrows.everywhere import PALETTE, STOP_KEYS
from fraese.ui.shape import AxisShape, Shape
from fraese.ui.views import VIEWS

OF_VIEWS = {view.AREA for view in VIEWS.values()}
UI = Path(fraese.ui.__file__).parent
TURNING = "abc"


def shape(axes: str, step_word: str = "half-step") -> Shape:
    return Shape(
        tuple(AxisShape(name, "°" if name in TURNING else "mm", 0.005) for name in axes), step_word
    )


def table(axes: str = "xyz") -> KeyTable:
    return KeyTable(shape(axes))


def keys_of(rows: KeyTable, action: str) -> str:
    return next(row.keys for row in rows.rows if row.action == action)


# --- nobody else names a key ---------------------------------------------------------------------

#: Keys as a person reads them in a sentence or a hint.
_FOR_PEOPLE = re.compile(
    r"[←→↑↓]|\b(?:Esc|Escape|Enter|Tab|Space|PgUp|PgDn|Home|End|F1|Ctrl\+\w)\b"
    r"|\b(?:[Pp]ress|[Kk]ey|with|hit) [b-zA-Z?]\b|\b[a-z]: [a-z]+"
)
#: Keys as Textual names them.
_FOR_TEXTUAL = {
    key
    for row in table("xyza").rows
    for key in row.keys.split(",")
    if len(key) > 1 and key not in ("end", "home", "left", "right")
}
_BINDINGS = {"Binding", "BINDINGS", "key_down", "on_key"}


def _docstrings(tree: ast.AST) -> set[int]:
    """Which nodes are docstrings, by id."""
    return {
        id(node.body[0].value)
        for node in ast.walk(tree)
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef)
        and node.body
        and isinstance(node.body[0], ast.Expr)
    }


def keys_named_in(source: str) -> list[str]:
    """Literals that name a key, and bindings that come from no table."""
    tree = ast.parse(source)
    docstrings = _docstrings(tree)
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            text = node.value
            if id(node) not in docstrings and (
                _FOR_PEOPLE.search(text) or _FOR_TEXTUAL & set(text.split(","))
            ):
                found.append(text)
        elif isinstance(node, ast.Name | ast.FunctionDef | ast.AsyncFunctionDef):
            name = node.id if isinstance(node, ast.Name) else node.name
            if name in _BINDINGS or name.startswith("key_"):
                found.append(name)
        elif isinstance(node, ast.Attribute) and node.attr == "BINDINGS":
            found.append(node.attr)
    return found


FILES = [path for path in sorted(UI.rglob("*.py")) if path.parent.name != "keyrows"]


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(UI)))
def test_only_the_key_table_names_keys(path: Path) -> None:
    found = keys_named_in(path.read_text("utf-8"))
    if path.name == "bindings.py":  # the one place where rows become bindings
        found = [name for name in found if name != "Binding"]
    if path.name == "pastes.py":  # what is pasted is text: these two stand for white space
        found = [name for name in found if name not in ("enter", "tab")]
    assert found == []


@pytest.mark.parametrize(
    "line",
    [
        'BINDINGS = [("p", "press")]',
        'Binding("p", "press")',
        'bind("escape", "back")',
        'KEYS = "Enter: go   x y z m: choose   Esc: back"',
        'say("No program: press o to open one.")',
        'say(f"{name}: Start it with s.")',
        'say("stop it (Esc) or wait")',
        'keys = "p: press, let go (simulated)"',
        'if event.key == "pageup": pass',
        "def key_p(self): pass",
        "async def on_key(self, event): pass",
    ],
)
def test_a_key_that_is_named_elsewhere_is_seen(line: str) -> None:
    assert keys_named_in(line)


def test_that_a_command_is_named_in_a_sentence() -> None:
    said = table().said
    assert [said(f"app.{name}") for name in ("stop_machine", "quit")] == ["Esc", "Ctrl+Q"]
    assert PALETTE.said == "Ctrl+P"
    assert [said(name) for name in ("open", "start", "acknowledge")] == ["o", "s", "Enter"]


# --- the table itself ----------------------------------------------------------------------------


@pytest.mark.parametrize("axes", ["xyz", "x", "xy", "xyza", "xyuv", "a", "aw", "xzac", "abcw"])
def test_every_key_of_an_area_means_one_thing(axes: str) -> None:
    rows = table(axes)
    everywhere = _keys(rows.of(Area.EVERYWHERE))
    for area in Area:
        here = _keys(rows.of(Area.VIEWS, area) if area in OF_VIEWS else rows.of(area))
        assert len(here) == len(set(here))
        # What works everywhere would hide the same key of a dialog; only the stop key is free, to
        # go back, while nothing moves.
        if area is not Area.EVERYWHERE:
            assert set(here) & set(everywhere) <= STOP_KEYS


def _keys(rows: Iterable[Row]) -> list[str]:
    return [key for row in rows for key in row.keys.split(",") if key]


def test_every_command_has_a_group_and_a_sentence() -> None:
    commands = table("xyza").commands
    assert {command.group for command in commands} | {"Macros"} == set(GROUPS)
    assert all(command.help.endswith(".") and command.title for command in commands)
    assert not [row for row in table().rows if row.group and row not in table().commands]


def test_only_what_works_everywhere_or_says_yes_has_priority() -> None:
    rows = [row for row in table("xyza").rows if row.priority]
    assert {row.action for row in rows} == {"app.stop_machine", "app.quit", "accept"}
    assert all(row.priority for row in rows if row.area is Area.EVERYWHERE)
    assert {"escape", "ctrl+c"} == STOP_KEYS


def test_hints_are_made_of_the_table() -> None:
    rows = table()
    assert rows.hint(Area.REFERENCE) == "Enter: go   x y z m: choose   Esc: back"
    assert rows.hint(Area.GO_TO) == "Enter: go   ↑ ↓: counted from   Esc: back"
    assert rows.hint(Area.OPEN) == "Enter: open   Tab: to the files   Esc: back"
    assert rows.hint(Area.ASK) == (
        "Enter: go on   m: move by hand   l: lift the tool   Esc: stop the job"
    )
    assert rows.hint(Area.SWITCHES, but="press") == "↑ ↓: ask for another one   Esc: back"
    assert rows.hint(Area.SWITCHES).startswith("p: press, let go (simulated)   ↑ ↓")
    assert table("xya").hint(Area.REFERENCE) == "Enter: go   x y a m: choose   Esc: back"


# --- one to four axes ----------------------------------------------------------------------------

OWN = {"x": ("left", "right"), "y": ("down", "up"), "z": ("pagedown", "pageup")}
FOURTH = ("end", "home")


def jog_keys(rows: KeyTable, axis: str) -> tuple[str, str]:
    return keys_of(rows, f"jog('{axis}', -1)"), keys_of(rows, f"jog('{axis}', 1)")


@pytest.mark.parametrize(
    ("axes", "places"),
    [
        ("xyz", OWN),
        ("zx", OWN),
        ("xyza", {**OWN, "a": FOURTH}),
        ("wzyx", {**OWN, "w": FOURTH}),
        ("a", {"a": FOURTH}),
        ("xyuv", {**OWN, "u": FOURTH, "v": OWN["z"]}),
        ("abcu", {"a": FOURTH, "b": OWN["z"], "c": OWN["y"], "u": OWN["x"]}),
    ],
)
def test_axes_are_jogged_by_place(axes: str, places: dict[str, tuple[str, str]]) -> None:
    rows = table(axes)
    assert {axis: jog_keys(rows, axis) for axis in axes} == {axis: places[axis] for axis in axes}


@pytest.mark.parametrize(
    ("axes", "keys"),
    [
        ("xyz", "XYZ"),
        ("xyzb", "XYZB"),
        ("xyza", "XYZ0"),
        ("xywa", "XY09"),
        ("bcuv", "BCUV"),
    ],
)
def test_axes_are_zeroed_by_their_letter_where_it_is_free(axes: str, keys: str) -> None:
    rows = table(axes)
    assert "".join(keys_of(rows, f"zero('{axis}')") for axis in axes) == keys
    assert keys_of(rows, "zero('')") == "A"
    assert keys_of(rows, "width(-1)") == "W,minus"


def test_the_list_of_three_axes_is_what_it_was() -> None:
    shown = [row.shown for row in table().listed]
    assert " ".join(shown) == "Esc Space Enter PgUp PgDn q ← → ↓ ↑ g r X Y Z A o s v t e i l F1"


def test_a_turning_axis_turns_and_steps_have_their_name() -> None:
    rows = KeyTable(shape("xyza", "quarter-step"))

    def row(action: str) -> Row:
        return next(row for row in rows.rows if row.action == action)

    assert row("jog('a', 1)").help == "Turn A by one step width in positive direction."
    assert row("jog('x', 1)").help == "Move X by one step width in positive direction."
    assert row("set_width(0)").title == "Step 1 quarter-step"
    assert row("set_width(1)").title == "Step 0.01 mm,°"
    assert rows.notes()[0].startswith("At quarter-step width")
    assert not [row for row in rows.rows if "half" in row.title + row.help]
