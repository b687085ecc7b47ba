"""``python -m bench.campaign [WORD ...]``: try the kinds with all words in their names."""

import argparse
import sys

from bench.campaign.frame import HEAD, Kind, attempted, campaign, say
from bench.campaign.kinds import KINDS


def chosen(words: list[str]) -> list[Kind]:
    """Kinds with all of these words in their names; all kinds without any."""
    return [kind for kind in KINDS if all(word in kind.name for word in words)]


def main(arguments: list[str] | None = None) -> int:
    """0: every step is accounted for."""
    parser = argparse.ArgumentParser(prog="python -m bench.campaign", description=__doc__)
    parser.add_argument("words", nargs="*")
    parser.add_argument("--tries", type=int, default=0, help="of each kind; 0: its own number")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1, help="attempts at once")
    parser.add_argument("--short", action="store_true", help="a few of each kind")
    parser.add_argument("--only", type=int, help="this attempt of each kind, and what it says")
    given = parser.parse_args(arguments)
    kinds = chosen(given.words)
    if not kinds:
        print(f"no kind has all of these in its name: {' '.join(given.words)}")
        return 1
    bad = 0
    print(HEAD, flush=True)
    for kind in kinds:
        if why := kind.missing():
            print(f"| {kind.name} | 0 | - | - | - | {why} |", flush=True)
            continue
        if given.only is not None:
            print(attempted(kind, given.seed, given.only))
            continue
        tries = given.tries or (kind.few if given.short else kind.many)
        row = campaign(kind, tries, given.seed, given.jobs)
        bad += row.unaccounted
        say(row)
    return int(bad > 0)


if __name__ == "__main__":
    sys.exit(main())
