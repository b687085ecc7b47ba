"""How a program that was cut short is gone on with."""

import threading
from collections.abc import Iterator, Sequence
from itertools import groupby

from textual.app import ComposeResult
from textual.containers import VerticalScroll
from textual.widgets import Button

from fraese.errors import FraeseError
from fraese.phrases import shown, spoken
from fraese.ui.dialogs.dialog import Dialog
from fraese.ui.keyrows import Area, KeyTable
from fraese.ui.programs import Resumption, Way
from fraese.ui.widgets.fact import Fact


class ResumeDialog(Dialog[int]):
    """Shows what it would do, from the place or some moves before it; answers with how many.

    The program is read as far as the place in a thread of its own, since that may take long.

    Args:
        keys: the table.
        resumption: what is to be shown.
    """

    AREA = Area.RESUME
    COVERS = True
    HEADING = spoken("Go on with a program")
    YES = spoken("Go on")

    def __init__(self, keys: KeyTable, resumption: Resumption) -> None:
        super().__init__(keys)
        self._resumption = resumption
        self._moves_back = 0
        # Of so many moves back; None: it is not known yet, or there is none.
        self._way: Way | None = None
        self._is_open = True
        self._cut_short = Fact("", classes="one-line")
        self._line = Fact("", classes="one-line line-text")
        self._told = VerticalScroll(id="way", can_focus=False)

    def inner(self) -> ComposeResult:
        """The place, and the way there."""
        yield self._cut_short
        yield self._line
        yield self._told

    def on_mount(self) -> None:
        """Begin to read."""
        self._read()

    def on_unmount(self) -> None:
        """Nobody wants to know any more."""
        self._is_open = False

    # --- the way ---------------------------------------------------------------------------------

    def action_earlier(self, moves: int) -> None:
        """Begin so many moves earlier, or later; never behind the place."""
        back = min(max(self._moves_back + moves, 0), self._resumption.moves)
        if back != self._moves_back:
            self._moves_back = back
            self._read()

    def _read(self) -> None:
        back, self._way = self._moves_back, None
        self._cut_short.show(
            spoken("{name} is being read as far as the place …", name=self._resumption.name)
        )

        def read() -> None:
            try:
                # Read here, where nobody waits.
                _ = self._resumption.program.lines
                way = self._resumption.way(back, lambda: not self._is_wanted(back))
            except FraeseError as error:
                self.call_later(self._failed, back, str(error))
            except Exception as error:  # of a reader, which must not end the control of a machine
                self.call_later(
                    self._failed,
                    back,
                    spoken("Reading the program failed: {error}.", error=repr(error)),
                )
            else:
                self.call_later(self._known, back, way, self._resumption.news())

        threading.Thread(target=read, name="way", daemon=True).start()

    def _is_wanted(self, back: int) -> bool:
        return self._is_open and back == self._moves_back

    def _failed(self, back: int, sentence: str) -> None:
        if self._is_wanted(back):
            self.complain(sentence)

    def _known(self, back: int, way: Way, news: Sequence[str]) -> None:
        if not self._is_wanted(back):
            return
        self._way = way
        name = self._resumption.name
        moves = spoken("{back} moves", back=back) if back > 1 else spoken("1 move")
        self._cut_short.show(
            spoken(
                "{name} goes on in line {line}, {moves} before it was cut short:",
                name=name,
                line=way.line,
                moves=moves,
            )
            if back
            else spoken("{name} was cut short in line {line}:", name=name, line=way.line)
        )
        self._line.show(way.text)
        self._told.remove_children()
        self._told.mount_all(_told(way, news))
        self.complain("")

    def action_scroll(self, pages: int) -> None:
        """Where there is no room for all of it."""
        self._told.scroll_relative(y=pages * self._told.size.height, animate=False)

    # --- the answer ------------------------------------------------------------------------------

    def action_accept(self) -> None:
        """Go on, if the way was shown."""
        if self.query_one("#back", Button).has_focus:
            self.action_back()
        elif self._way is not None:
            self.dismiss(self._moves_back)


def _told(way: Way, news: Sequence[str]) -> Iterator[Fact]:
    for sentence in news:
        yield Fact(sentence, classes="fact -warn")
    yield Fact(spoken("In force: {in_force}.", in_force=way.in_force), classes="fact")
    over = (
        spoken("Safe height: {height}.", height=way.height)
        if way.height
        else spoken("Nothing lifts the tool.")
    )
    yield Fact(spoken("{over} On the way:", over=over), classes="fact")
    for moves, legs in groupby(way.legs, lambda leg: leg[2]):
        if not moves:
            yield Fact("; ".join(shown(words) for words, _, _ in legs), classes="fact leg")
            continue
        for words, work, _ in legs:
            yield Fact(words, classes="fact leg")
            if work:
                yield Fact(work, classes="fact leg work")
