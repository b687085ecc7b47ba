"""What a kind of fault is, how it is tried, and the row that comes of it."""

import itertools
import random
import statistics
import tempfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

#: So many attempts of a kind in the whole campaign, and in the short one.
MANY: Final = 300
FEW: Final = 2
#: A machine that is late once too often is not busy.
_REPEATS: Final = 2
#: What is said where a disk, or a simulated chip, was given no time for seconds.
_NO_TIME: Final = ("the disk takes no record", "does not answer any more")
#: More complaints of a kind than this are only counted.
_SHOWN: Final = 5
#: Characters of a complaint; ``--only`` shows all.
_NOTE: Final = 600


class Late(Exception):
    """A bound of time that only a machine with time to spare meets: the attempt is repeated.

    What is late each time is unaccounted for.
    """


@dataclass(frozen=True)
class Attempt:
    """One fault, injected once.

    Attributes:
        folder: fresh, and gone afterwards.
        random: for the moment, and all else that is left to chance.
        number: from 0.
    """

    folder: Path
    random: random.Random
    number: int


@dataclass(frozen=True)
class Outcome:
    """What came of it.

    Attributes:
        unaccounted: steps of any axis beyond what was claimed, all axes added up; another sort of
            broken promise counts as 1.
        figure: what the kind measures, in its unit; None: there was nothing to measure.
        note: what is to be said about it, where it is unaccounted for.
        missed: the fault came too late or too early to be one: another attempt is made.
        repeats: how often it was late before.
    """

    unaccounted: int = 0
    figure: float | None = None
    note: str = ""
    missed: bool = False
    repeats: int = 0


@dataclass(frozen=True)
class Kind:
    """A kind of fault.

    Attributes:
        name: as in the table; words on the command line choose by it.
        measures: what the figure is, with its unit.
        attempt: injects it once.
        many: attempts in the whole campaign.
        few: attempts in the short one.
        missing: why it cannot be tried here; empty: it can.
        alone: real time is measured; attempts do not share the computer with each other.
    """

    name: str
    measures: str
    attempt: Callable[[Attempt], Outcome]
    many: int = MANY
    few: int = FEW
    missing: Callable[[], str] = lambda: ""
    alone: bool = False


@dataclass(frozen=True)
class Row:
    """What came of all attempts of a kind.

    Attributes:
        kind: which.
        tries: that were no miss.
        unaccounted: attempts with steps unaccounted for.
        figures: all that were measured.
        complaints: number and note of attempts that broke a promise.
        repeated: attempts that were late at first.
    """

    kind: Kind
    tries: int
    unaccounted: int
    figures: Sequence[float]
    complaints: Sequence[tuple[int, str]]
    repeated: int = 0

    def __str__(self) -> str:
        worst = middle = "-"
        if self.figures:
            worst, middle = f"{max(self.figures):.4g}", f"{statistics.median(self.figures):.4g}"
        cells = (self.kind.name, self.tries, self.unaccounted, middle, worst, self.kind.measures)
        return "| " + " | ".join(map(str, cells)) + " |"


HEAD: Final = "| kind | n | unaccounted | median | worst | measured |\n|---|---|---|---|---|---|"


def attempted(kind: Kind, seed: int, number: int) -> Outcome:
    """One attempt; whatever it raises is something unaccounted for."""
    for repeats in range(_REPEATS):
        try:
            return replace(_once(kind, seed, number), repeats=repeats)
        except Late:
            continue
    try:
        return replace(_once(kind, seed, number), repeats=_REPEATS)
    except Late as error:
        return Outcome(unaccounted=1, note=f"late each time: {error}", repeats=_REPEATS)


def _once(kind: Kind, seed: int, number: int) -> Outcome:
    chance = random.Random(f"{seed}/{kind.name}/{number}")
    # A fault's leftovers may hold files open for a moment: what cannot be removed is left.
    with tempfile.TemporaryDirectory(prefix="fraese-", ignore_cleanup_errors=True) as folder:
        try:
            return kind.attempt(Attempt(Path(folder), chance, number))
        except Late:
            raise
        except Exception as error:
            said = f"{type(error).__name__}: {error}"
            if any(words in said for words in _NO_TIME):
                raise Late(said) from error
            return Outcome(unaccounted=1, note=said)


class Tally:
    """What came of the attempts of a kind so far.

    Args:
        kind: which.
        seed: of all chance.
        jobs: attempts at once.
    """

    def __init__(self, kind: Kind, seed: int = 1, jobs: int = 1) -> None:
        self.kind = kind
        self._seed, self._jobs = seed, 1 if kind.alone else jobs
        self._next = itertools.count()
        self.done = 0
        self._unaccounted = 0
        self._figures: list[float] = []
        self._complaints: list[tuple[int, str]] = []
        self._repeated = 0

    def go_on(self, tries: int) -> None:
        """Attempts until so many more were no miss; at most twice as many as that."""
        until, numbers = self.done + tries, itertools.islice(self._next, 2 * tries)
        while self.done < until:
            # Never more at once than are still wanted: none is made in vain.
            batch = list(itertools.islice(numbers, until - self.done))
            if not batch:
                return
            for number, outcome in _outcomes(self.kind, batch, self._seed, self._jobs):
                self._take(number, outcome)

    def _take(self, number: int, outcome: Outcome) -> None:
        if not outcome.missed:
            self.done += 1
            self._repeated += bool(outcome.repeats)
            self._unaccounted += bool(outcome.unaccounted)
            self._figures += [] if outcome.figure is None else [outcome.figure]
        if outcome.unaccounted:
            self._complaints.append((number, f"{outcome.unaccounted} ({outcome.note})"))

    @property
    def row(self) -> Row:
        """For the table."""
        told = (self._figures, self._complaints, self._repeated)
        return Row(self.kind, self.done, self._unaccounted, *told)


def campaign(kind: Kind, tries: int, seed: int = 1, jobs: int = 1) -> Row:
    """Attempts until so many were no miss; at most twice as many as that."""
    tally = Tally(kind, seed, jobs)
    tally.go_on(tries)
    return tally.row


def _outcomes(
    kind: Kind, numbers: Iterable[int], seed: int, jobs: int
) -> Iterator[tuple[int, Outcome]]:
    """In the order of their numbers, however many are under way at once."""
    if jobs <= 1:
        for number in numbers:
            yield number, attempted(kind, seed, number)
        return
    with ThreadPoolExecutor(jobs) as pool:
        under_way = [(n, pool.submit(attempted, kind, seed, n)) for n in numbers]
        for number, outcome in under_way:
            yield number, outcome.result()


def say(row: Row) -> None:
    """The row, and what is to be complained of."""
    print(row, flush=True)
    for number, note in row.complaints[:_SHOWN]:
        print(f"    --only {number}: {note[:_NOTE]}", flush=True)
    if row.repeated:
        print(f"    {row.repeated} repeated: the machine was late", flush=True)
    if len(row.complaints) > _SHOWN:
        print(f"    and {len(row.complaints) - _SHOWN} more", flush=True)
