"""``python -m bench.campaign [WORD ...]``: try the kinds with all words in their names.

How far it is comes on standard error, the table at the end, also if it is broken off with Ctrl+C.
"""

import argparse
import signal
import sys

from bench.campaign.frame import HEAD, Kind, Tally, attempted, say
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
    parser.add_argument(
        "--round", type=int, default=0, help="so many of each kind in turn; 0: all of one first"
    )
    parser.add_argument("--short", action="store_true", help="a few of each kind")
    parser.add_argument("--only", type=int, help="this attempt of each kind, and what it says")
    given = parser.parse_args(arguments)
    kinds = chosen(given.words)
    if not kinds:
        print(f"no kind has all of these in its name: {' '.join(given.words)}")
        return 1
    if given.only is not None:
        for kind in kinds:
            print(attempted(kind, given.seed, given.only))
        return 0
    # Told to end, it says what it has seen until then.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    wanted = {kind: given.tries or (kind.few if given.short else kind.many) for kind in kinds}
    return int(_tried(wanted, given.seed, given.jobs, given.round) > 0)


def _tried(wanted: dict[Kind, int], seed: int, jobs: int, a_round: int) -> int:
    """All of them, in rounds; how many attempts have steps unaccounted for."""
    tallies = {kind: Tally(kind, seed, jobs) for kind in wanted if not kind.missing()}
    unfinished = list(tallies)
    try:
        while unfinished:
            for kind in unfinished:
                tally = tallies[kind]
                before, left = tally.done, wanted[kind] - tally.done
                tally.go_on(min(a_round or left, left))
                print(f"{tally.done} of {wanted[kind]}: {tally.row}", file=sys.stderr, flush=True)
                if tally.done == before:
                    # What always misses comes to an end.
                    wanted[kind] = tally.done
            unfinished = [kind for kind in unfinished if tallies[kind].done < wanted[kind]]
    except KeyboardInterrupt:
        print("broken off", flush=True)
    print(HEAD, flush=True)
    for kind in wanted:
        if kind in tallies:
            say(tallies[kind].row)
        else:
            print(f"| {kind.name} | 0 | - | - | - | {kind.missing()} |", flush=True)
    return sum(tally.row.unaccounted for tally in tallies.values())


if __name__ == "__main__":
    sys.exit(main())
