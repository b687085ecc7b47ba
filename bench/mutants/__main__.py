"""``python -m bench.mutants [word ...]``: try the faults whose names contain one of the words."""

import sys
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from bench.mutants.mutant import ROOT, Mutant
from bench.mutants.tables import MUTANTS
from bench.mutants.trial import Trial, Verdict

_BAD = (Verdict.SURVIVED, Verdict.BROKEN)


def stale(mutants: Sequence[Mutant]) -> list[str]:
    """Rows that do not fit the tree."""
    found = []
    for mutant in mutants:
        try:
            mutant.applied_to((ROOT / mutant.file).read_text("utf-8"))
        except (OSError, ValueError) as error:
            found.append(str(error))
    return found


def main(words: list[str]) -> int:
    """0: every fault was seen; 1: one survived, a row is stale, or the tree itself fails."""
    mutants = [m for m in MUTANTS if not words or any(word in m.name for word in words)]
    if not mutants:
        print(f"no row has {' or '.join(words)} in its name")
        return 1
    if complaints := stale(mutants):
        print("stale rows:", *complaints, sep="\n  ")
        return 1
    with tempfile.TemporaryDirectory() as folder:
        trial = Trial(Path(folder))
        if failed := trial.failure(test for mutant in mutants for test in mutant.tests):
            print(f"without any fault this fails; mend that first: {failed}")
            return 1
        counts: Counter[Verdict] = Counter()
        for mutant in mutants:
            since = time.monotonic()
            verdict, said = trial.verdict(mutant)
            counts[verdict] += 1
            took_s = time.monotonic() - since
            print(f"{mutant.name:60} {verdict.value}  ({took_s:.0f} s)  {said}", flush=True)
            if verdict in _BAD:
                print(f"    {mutant.file}: {mutant.old!r} -> {mutant.new!r}: {mutant.harm}")
    print(", ".join(f"{count} {verdict.value}" for verdict, count in counts.items()))
    return int(any(counts[verdict] for verdict in _BAD))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
