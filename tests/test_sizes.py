"""No file and no function of the package is too long to be taken in at once."""

import ast
from collections.abc import Iterator
from pathlib import Path

HOUSE = Path(__file__).parents[1] / "fraese"
MOST_LINES_OF_A_FILE = 400
MOST_LINES_OF_A_FUNCTION = 65


def functions(text: str) -> Iterator[tuple[str, int, int]]:
    """Name, first line and length of every function, methods and decorators with it."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            first = min([node.lineno, *(d.lineno for d in node.decorator_list)])
            yield node.name, first, (node.end_lineno or first) - first + 1


def test_no_file_is_too_long() -> None:
    lengths = {
        path.relative_to(HOUSE).as_posix(): len(path.read_text("utf-8").splitlines())
        for path in HOUSE.rglob("*.py")
    }
    assert len(lengths) > 100
    assert {file: n for file, n in lengths.items() if n > MOST_LINES_OF_A_FILE} == {}


def test_no_function_is_too_long() -> None:
    too_long = [
        f"{path.relative_to(HOUSE)}:{line} {name}: {length} lines"
        for path in sorted(HOUSE.rglob("*.py"))
        for name, line, length in functions(path.read_text("utf-8"))
        if length > MOST_LINES_OF_A_FUNCTION
    ]
    assert too_long == []


def test_a_long_function_would_be_seen() -> None:
    body = "".join(f"    x = {n}\n" for n in range(MOST_LINES_OF_A_FUNCTION))
    assert list(functions(f"@cache\ndef f():\n{body}")) == [("f", 1, MOST_LINES_OF_A_FUNCTION + 2)]
