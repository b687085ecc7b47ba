"""The sentences of the program, and the catalogues of their translations brought up to date.

    python -m rigs.catalogue          new sentences are put in without a translation, old ones out
    python -m rigs.catalogue --check  only says what is missing

A sentence is the literal that stands in ``phrase(...)``, the description of a key of the
configuration, or what the system says of files that cannot be had. Entries are sorted by file and
text, so that work on different files can be brought together.
"""

import ast
import errno
import importlib
import os
import pkgutil
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import typer

from fraese.cli import app
from fraese.cli.table import MODULES, commands_of
from fraese.phrases import ENGLISH, LANGUAGES, catalogue_path, parsed
from fraese.ui import keyrows
from fraese.ui.keyrows import Row

HOUSE: Final = Path(__file__).parents[1] / "fraese"
#: What the system says when a file cannot be had.
_REASONS: Final = (
    errno.ENOENT,
    errno.EACCES,
    errno.EPERM,
    errno.EISDIR,
    errno.ENOTDIR,
    errno.ENOSPC,
    errno.EROFS,
    errno.EIO,
    errno.EBUSY,
    errno.ENODEV,
    errno.ENXIO,
    errno.ENAMETOOLONG,
    errno.ELOOP,
    errno.EEXIST,
    errno.EPIPE,
    errno.ETIMEDOUT,
)
#: What the checker of the configuration says, after it was put in words of ours.
_CHECKED: Final = tuple(
    f"must be {what}"
    for what in ("true or false", "a list", "a whole number", "a text in quotes", "a table")
)
_HEAD: Final = """\
# Catalogue of fraese, brought up to date by python -m rigs.catalogue.
msgid ""
msgstr ""
"Language: {language}\\n"
"Content-Type: text/plain; charset=UTF-8\\n"
"""


def sentences() -> dict[str, str]:
    """Every template, and the first file that it stands in."""
    found: dict[str, str] = {}
    for path in sorted({*HOUSE.rglob("*.py")} - {HOUSE / "phrases.py"}):
        for template in literals(ast.parse(path.read_text("utf-8"))):
            found.setdefault(template, path.relative_to(HOUSE).as_posix())
    for words, file in _helps():
        found.setdefault(words, file)
    for words, file in _rows():
        found.setdefault(words, file)
    for words in (*_CHECKED, *map(os.strerror, _REASONS)):
        found.setdefault(words, "")
    return found


def _helps() -> Iterator[tuple[str, str]]:
    """What commands say of themselves and of their options, and their files."""

    def below(command: Any) -> Iterator[tuple[str, str]]:
        texts = [command.help, *(getattr(each, "help", None) for each in command.params)]
        yield from ((text, "cli") for text in texts if text)
        for inner in getattr(command, "commands", {}).values():
            yield from below(inner)

    yield from below(typer.main.get_command(app))
    for module in dict.fromkeys(MODULES.values()):
        for command in commands_of(module).values():
            yield from below(command)


def _rows() -> Iterator[tuple[str, str]]:
    """What the tables of the app's keys say, and their files."""
    for module in pkgutil.iter_modules(keyrows.__path__, f"{keyrows.__name__}."):
        values = vars(importlib.import_module(module.name)).values()
        for row in filter(lambda each: isinstance(each, Row), _each(tuple(values))):
            texts = (row.title, row.help, row.group, row.footer, row.hint)
            for text in filter(None, texts):
                yield text, module.name.removeprefix("fraese.").replace(".", "/") + ".py"


def _each(value: object) -> Iterator[Any]:
    if isinstance(value, tuple | dict):
        for inner in value.values() if isinstance(value, dict) else value:
            yield from _each(inner)
    else:
        yield value


def literals(tree: ast.AST) -> Iterator[str]:
    """What stands in ``phrase(...)`` or ``spoken(...)``, and in descriptions of keys."""
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call):
            continue
        name = node.func.id if isinstance(node.func, ast.Name) else ""
        if name in ("phrase", "spoken"):
            yield _text(node.args[0])
        elif name == "Field":
            yield from (_text(each.value) for each in node.keywords if each.arg == "description")


def _text(node: ast.expr) -> str:
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return node.value
    raise SystemExit(f"line {node.lineno}: a template is a literal, not {ast.unparse(node)}")


def placeholders(template: str) -> set[str]:
    """What stands in the braces of a template, formats included."""
    return set(re.findall(r"(?<!\{)\{([^{}]+)\}(?!\})", template))


def brought_up_to_date(language: str) -> str:
    """The catalogue with the sentences that there are, and the translations that were."""
    path = catalogue_path(language)
    # Editors of catalogues fold long lines.
    known = parsed(path.read_text("utf-8").replace('"\n"', "")) if path.exists() else {}
    entries = [_HEAD.format(language=language)]
    for template, file in sorted(sentences().items(), key=lambda entry: (entry[1], entry[0])):
        entries.append(entry(file, template, known.get(template, "")))
    return "\n".join(entries)


def entry(file: str, template: str, ours: str) -> str:
    """One sentence of a catalogue, and what stands for it."""
    place = f"#: fraese/{file}" if file else "#. system"
    return f'{place}\nmsgid "{_quoted(template)}"\nmsgstr "{_quoted(ours)}"\n'


def _quoted(text: str) -> str:
    return text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n").replace("\t", "\\t")


def main() -> int:
    """How many translations are missing decides."""
    missing = 0
    for language in LANGUAGES:
        if language == ENGLISH:
            continue
        path, text = catalogue_path(language), brought_up_to_date(language)
        if "--check" not in sys.argv:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, "utf-8")
        lacking = text.count('\nmsgstr ""\n\n') + text.endswith('\nmsgstr ""\n')
        print(f"{path.name} ({language}): {lacking} without translation")
        missing += lacking
    return int(missing > 0)


if __name__ == "__main__":
    sys.exit(main())
