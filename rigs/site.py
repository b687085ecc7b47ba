"""What mkdocs is told beyond docs/: pages made from the program, and files that pages lead to.

    README.md, CHANGELOG.md      pages, as they are; the README is the first
    commands/                    every command's help, made from the program
    decisions/                   a list of them, by their titles
    ../fraese.toml and the like  put beside the pages, so that what leads to them leads somewhere

Rule 1: files of the tree keep links that work in the tree; they are turned here. A link that leads
        nowhere is left, and ends the build (``mkdocs build --strict``).
"""

import posixpath
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

from mkdocs.structure.files import File, Files

ROOT: Final = Path(__file__).parents[1]
# mkdocs reads this file by its path.
sys.path.insert(0, str(ROOT))

from rigs import manual  # noqa: E402

DOCS: Final = ROOT / "docs"
#: Pages from outside of docs/, and where they are put.
_PAGES: Final = {ROOT / "README.md": "index.md", ROOT / "CHANGELOG.md": "changelog.md"}
#: Where all else from outside is put.
_TREE: Final = "tree"
_LINK: Final = re.compile(r"(\]\()([^)#\s]+)((?:#[^)\s]*)?\))")
#: Pages in mkdocs.yml.
_PLACE: Final = re.compile(r"[\w./-]+\.md")
_TITLE: Final = re.compile(r"^# (.+)$", re.MULTILINE)


def on_config(config: Any) -> Any:
    """Every command is in the list of pages, and so is a page that nobody has put there."""
    nav = config["nav"]
    listed = set(_PLACE.findall(str(nav)))
    names = [page.name.split()[-1] for page in manual.root().inner]
    for part in nav:
        if "Commands" in part:
            pages = [{f"fraese {name}": f"commands/{name}.md"} for name in names]
            part["Commands"] = [part["Commands"], *pages]
    more = sorted(path.name for path in DOCS.glob("*.md") if path.name not in listed)
    if more:
        nav.append({"More": more})
    return config


def on_files(files: Files, config: Any) -> Files:
    """Put in what is made here."""
    made = {place: _text(path, place) for path, place in _PAGES.items()}
    made["decisions/index.md"] = _decisions()
    made |= _commands()
    for path in sorted(_led_to([*DOCS.rglob("*.md"), *_PAGES])):
        place = _place(path)
        if path.is_dir():
            made[place] = _listing(path)
        elif path.suffix == ".md":
            made[place] = _text(path, place)
        else:
            files.append(File.generated(config, place, abs_src_path=str(path)))
    for place, text in made.items():
        files.append(File.generated(config, place, content=text))
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Turn what leads out of docs/; what was made here is turned already."""
    place = page.file.src_uri
    path = DOCS / place
    return _turned(markdown, path, place) if path.exists() else markdown


def _place(path: Path) -> str:
    """Where a file or folder of the tree is in the site."""
    if path in _PAGES:
        return _PAGES[path]
    inside = path.is_relative_to(DOCS)
    below = path.relative_to(DOCS if inside else ROOT).as_posix()
    place = below if inside else f"{_TREE}/{below}"
    return f"{place}/index.md" if path.is_dir() else place


def _targets(text: str, path: Path) -> Iterator[Path]:
    """What a page leads to and is in the tree."""
    for _, link, _ in _LINK.findall(text):
        target = (path.parent / link).resolve()
        if target.exists() and target.is_relative_to(ROOT):
            yield target


def _led_to(pages: list[Path]) -> set[Path]:
    """Everything outside of docs/ that these pages lead to, and what that leads to in turn."""
    found: set[Path] = set()
    while pages:
        page = pages.pop()
        inner = page.iterdir() if page.is_dir() else _targets(page.read_text("utf-8"), page)
        for target in inner:
            if target in found or target in _PAGES or target.is_relative_to(DOCS):
                continue
            found.add(target)
            if target.is_dir() or target.suffix == ".md":
                pages.append(target)
    return found


def _text(path: Path, place: str) -> str:
    return _turned(path.read_text("utf-8"), path, place)


def _turned(text: str, path: Path, place: str) -> str:
    """A page of the tree as a page of the site."""

    def turned(match: re.Match[str]) -> str:
        target = (path.parent / match[2]).resolve()
        if not (target.exists() and target.is_relative_to(ROOT)):
            return match[0]
        return match[1] + posixpath.relpath(_place(target), posixpath.dirname(place)) + match[3]

    return _LINK.sub(turned, text)


def _decisions() -> str:
    rows = []
    for path in sorted((DOCS / "decisions").glob("*.md")):
        title = _TITLE.search(path.read_text("utf-8"))
        rows.append(f"- [{title[1] if title else path.stem}]({path.name})")
    return "\n".join(["# Why it is as it is", "", *rows, ""])


def _listing(folder: Path) -> str:
    rows = [f"- [{path.name}]({path.name})" for path in sorted(folder.iterdir()) if path.is_file()]
    return "\n".join([f"# {folder.relative_to(ROOT).as_posix()}", "", *rows, ""])


def _commands() -> dict[str, str]:
    """A page for each command, and one that lists them."""
    top = manual.root()
    made, rows = {}, []
    for page in top.inner:
        name = page.name.split()[-1]
        made[f"commands/{name}.md"] = manual.markdown(page)
        said = page.help.split("\n")[0]
        rows.append(f"- [`{page.name}`]({name}.md): {said}")
    alone = manual.markdown(top._replace(inner=())).replace("# fraese", "# Commands", 1)
    made["commands/index.md"] = "\n".join([alone, *rows, ""])
    return made
