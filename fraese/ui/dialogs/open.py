"""Which program to open."""

from collections.abc import Iterable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Final

from rich.text import Text, TextType
from textual import on
from textual.app import ComposeResult
from textual.strip import Strip
from textual.widgets import DirectoryTree, Input, OptionList
from textual.widgets.option_list import Option

from fraese.phrases import spoken
from fraese.plaintext import dotted, plain
from fraese.ui.dialogs.dialog import Dialog
from fraese.ui.keyrows import Area, KeyTable
from fraese.ui.widgets.options import Options

#: A key in a longer text takes longer than the next needs to come.
_LONGEST: Final = 2_000
#: So many of those opened last are offered.
_MOST_RECENT: Final = 6


def _in_short(path: Path) -> str:
    """Its name first: that is what a person looks for."""
    folder = str(path.parent)
    home = str(Path.home())
    if folder == home or folder.startswith(f"{home}/"):
        folder = f"~{folder.removeprefix(home)}"
    return plain(f"{path.name}   {folder}")


class FileTree(DirectoryTree):
    """Folders and files, hidden ones left out."""

    ICON_NODE = "▸ "
    ICON_NODE_EXPANDED = "▾ "
    ICON_FILE = "  "

    def filter_paths(self, paths: Iterable[Path]) -> Iterable[Path]:
        """Leave out what is hidden."""
        return [path for path in paths if not path.name.startswith(".")]

    def process_label(self, label: TextType) -> Text:
        """A name is shown, and not obeyed."""
        return Text(plain(str(label)))


class PathInput(Input):
    """Takes any path, and shows it with dots for what must not reach the terminal."""

    def render_line(self, y: int) -> Strip:
        """One line of the screen."""
        strip = super().render_line(y)
        return Strip([segment._replace(text=dotted(segment.text)) for segment in strip])


class OpenDialog(Dialog[Path]):
    """A program file: its path is typed, or it is chosen from those opened last, or from the tree.

    Args:
        keys: the table.
        folder: where the tree begins.
        path: what is in the input.
        recent: files that were opened, newest first.
    """

    AREA = Area.OPEN
    COVERS = True
    HEADING = spoken("Open a program")
    YES = spoken("Open")
    EXAMPLE = spoken("path of a program file")

    def __init__(
        self, keys: KeyTable, folder: Path, path: str, recent: Sequence[Path] = ()
    ) -> None:
        super().__init__(keys)
        self._folder = folder
        self._path = path
        self._recent = tuple(recent)[:_MOST_RECENT]

    def inner(self) -> ComposeResult:
        """Input, what was opened last, and tree."""
        yield PathInput(self._path, placeholder=self.EXAMPLE, id="file", max_length=_LONGEST)
        if self._recent:
            options = (Option(Text(_in_short(path), no_wrap=True)) for path in self._recent)
            yield Options(*options, id="recent", compact=True)
        yield FileTree(self._folder, id="tree")

    def nothing_typed(self) -> None:
        """Enter, and no name."""
        self.complain(spoken("Type the path of a program file, or choose one below."))

    @on(OptionList.OptionSelected, "#recent")
    def _again(self, event: OptionList.OptionSelected) -> None:
        self.dismiss(self._recent[event.option_index])

    @on(DirectoryTree.FileSelected)
    def _chosen(self, event: DirectoryTree.FileSelected) -> None:
        self.dismiss(event.path)

    def action_accept(self) -> None:
        """What was typed."""
        text = self.query_one("#file", Input).value.strip()
        if not text:
            self.nothing_typed()
            return
        path = Path(text)
        with suppress(RuntimeError):  # nobody of that name has a home
            path = path.expanduser()
        self.dismiss(path)


class MapDialog(OpenDialog):
    """A height map for the program that is open; no path is none, which is ``Path()``."""

    AREA = Area.MAP
    HEADING = spoken("Height map for this program")
    YES = spoken("Take it")
    EXAMPLE = spoken("path of a height map; empty: none")

    def nothing_typed(self) -> None:
        """None."""
        self.dismiss(Path())
