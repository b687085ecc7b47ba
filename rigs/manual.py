"""Every command's help as the program gives it: pages of the documentation, and the man page.

    python -m rigs.manual    writes share/: the man page, completion for shells

Nothing of it is kept by hand: a test sees that ``share/`` is as the program is.
"""

import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final, NamedTuple

import typer

from fraese.cli import app
from fraese.cli.completion import Shell, script_for
from fraese.cli.table import MODULES, commands_of

ROOT: Final = Path(__file__).parents[1]
#: Where a shell looks for what completes a command's words, below share/.
_COMPLETIONS: Final = {
    Shell.BASH: "bash-completion/completions/fraese",
    Shell.ZSH: "zsh/site-functions/_fraese",
    Shell.FISH: "fish/vendor_completions.d/fraese.fish",
}
#: zsh reads the file when it is first asked to complete; that time it is to be answered, too.
_AT_FIRST: Final = {
    Shell.ZSH: '\n[[ $funcstack[1] = _fraese ]] && _fraese_completion "$@"\n',
}
_EXIT_CODES: Final = {
    "0": "Done.",
    "1": "The job failed, an alarm stopped it, nobody answered, or the port cannot be had.",
    "2": "Wrong usage, file or configuration; nothing has moved.",
    "130": "Cancelled.",
}
_ENVIRONMENT: Final = {"FRAESE_LANGUAGE": "Language of everything that is said: en or de."}
_FILES: Final = {
    "fraese.toml": "Configuration, here; else in the user's configuration folder.",
}


class Words(NamedTuple):
    """An argument or option: as it is typed, and what it is."""

    typed: str
    help: str


class Page(NamedTuple):
    """The help of one command.

    Attributes:
        name: with all before it, such as "fraese config init".
        usage: what is typed behind the name.
        help: what it does.
        arguments: in order,
        options: likewise.
        inner: pages of the commands below it.
    """

    name: str
    usage: str
    help: str
    arguments: tuple[Words, ...]
    options: tuple[Words, ...]
    inner: tuple["Page", ...]


def root() -> Page:
    """The whole program."""
    top = _page(typer.main.get_command(app), "fraese", None)
    listed = commands_of_all()
    return top._replace(inner=tuple(_page(each, f"fraese {name}", None) for name, each in listed))


def commands_of_all() -> list[tuple[str, Any]]:
    """All commands by name, in the order of the help."""
    return [(name, commands_of(module)[name]) for name, module in MODULES.items()]


def _page(command: Any, name: str, parent: Any) -> Page:
    context = command.context_class(command, info_name=name, parent=parent)
    pieces = [piece for piece in command.collect_usage_pieces(context) if piece]
    arguments, options = [], []
    for parameter in command.get_params(context):
        record = parameter.get_help_record(context)
        if parameter.param_type_name == "argument":
            typed = parameter.metavar or parameter.name.upper()
            arguments.append(Words(typed, " ".join((parameter.help or "").split())))
        elif record is not None:
            options.append(Words(_plain(record[0]), " ".join(record[1].split())))
    inner = getattr(command, "commands", {})
    return Page(
        name,
        " ".join(pieces),
        (command.help or "").strip(),
        tuple(arguments),
        tuple(options),
        tuple(_page(each, f"{name} {word}", None) for word, each in inner.items()),
    )


def _plain(text: str) -> str:
    return re.sub(r"\s+", " ", text)


def every(page: Page) -> Iterator[Page]:
    """A page and all below it, in order."""
    yield page
    for inner in page.inner:
        yield from every(inner)


# --- Markdown ----------------------------------------------------------------


def markdown(page: Page) -> str:
    """A page of the documentation, commands below it included."""
    return "\n".join(_markdown(page, 1)) + "\n"


def _markdown(page: Page, level: int) -> Iterator[str]:
    yield from (f"{'#' * level} {page.name}", "")
    yield from (page.help, "")
    yield from ("```", f"{page.name} {page.usage}".rstrip(), "```", "")
    for title, rows in (("argument", page.arguments), ("option", page.options)):
        if rows:
            yield from (f"| {title} | |", "|---|---|")
            yield from (f"| `{_cell(row.typed)}` | {_cell(row.help)} |" for row in rows)
            yield ""
    for inner in page.inner:
        yield from _markdown(inner, level + 1)


def _cell(text: str) -> str:
    return text.replace("|", r"\|")


# --- roff ----------------------------------------------------------------


def man_page(version: str) -> str:
    """Of all commands, one page for man(1).

    Args:
        version: of the program.
    """
    return "\n".join(_man(root(), version)) + "\n"


def _man(top: Page, version: str) -> Iterator[str]:
    yield f'.TH FRAESE 1 "" "fraese {version}" "User Commands"'
    yield from (".SH NAME", "fraese \\- machine control for stepper-driven mills, in the terminal")
    yield from (".SH SYNOPSIS", ".B fraese", _roff(top.usage))
    yield from (".SH DESCRIPTION", _roff(_paragraphs(top.help)))
    yield ".SH OPTIONS"
    yield from _rows(top.options)
    yield ".SH COMMANDS"
    for page in [inner for each in top.inner for inner in every(each)]:
        yield from (f".SS {_roff(page.name)} {_roff(page.usage)}".rstrip(), _roff(page.help))
        yield from _rows((*page.arguments, *page.options))
    for title, rows in (
        ("EXIT STATUS", _EXIT_CODES),
        ("ENVIRONMENT", _ENVIRONMENT),
        ("FILES", _FILES),
    ):
        yield f".SH {title}"
        yield from _rows(Words(*row) for row in rows.items())
    yield from (
        ".SH CAVEATS",
        "None of this is an emergency stop: that is a switch which cuts the power of spindle and",
        "motors without any software.",
    )


def _rows(rows: Any) -> Iterator[str]:
    for row in rows:
        yield from (".TP", f".B {_roff(row.typed)}", _roff(row.help))


def _paragraphs(text: str) -> str:
    return text.replace("\n\n", "\n.PP\n")


def _roff(text: str) -> str:
    escaped = text.replace("\\", "\\e").replace("-", "\\-")
    # A line that begins with a point or an apostrophe would be a request.
    return "\n".join(
        line if line == ".PP" else re.sub(r"^([.'])", r"\\&\1", line.strip())
        for line in escaped.splitlines()
        if line.strip()
    )


# --- files ----------------------------------------------------------------


def version() -> str:
    """Of the program, as its project says."""
    found: str = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["version"]
    return found


def shared_files() -> dict[str, str]:
    """What is made from the program, by path below share/."""
    found = {"man/man1/fraese.1": man_page(version())}
    for shell, place in _COMPLETIONS.items():
        found[place] = script_for(shell.value) + "\n" + _AT_FIRST.get(shell, "")
    return found


def main() -> None:
    """Write them."""
    for place, text in shared_files().items():
        path = ROOT / "share" / place
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8")
        print(path.relative_to(ROOT))


if __name__ == "__main__":
    main()
