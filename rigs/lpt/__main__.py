"""``python -m rigs.lpt [BOOT...]``: run the real-kernel rig and say what held."""

import sys
import time
import traceback
from pathlib import Path
from tempfile import TemporaryDirectory

from rigs.lpt.boots import BOOTS, at_once
from rigs.lpt.checks import check
from rigs.lpt.kernel import CACHE, NotHere, kernel


def main(names: list[str]) -> int:
    """Run these boots, or all; the number of scenarios that failed."""
    failed = 0
    started_s = time.monotonic()
    with (
        TemporaryDirectory(dir=CACHE) as folder,
        at_once(names or list(BOOTS), kernel(), Path(folder)) as booting,
    ):
        for name, boot in booting.items():
            outcomes = boot.result()
            print(f"{name}: there after {time.monotonic() - started_s:.1f} s")
            for scenario, outcome in outcomes.items():
                try:
                    check(scenario, outcome)
                    print(f"  ok      {scenario} ({len(outcome.accesses)} accesses)")
                except AssertionError:
                    failed += 1
                    print(f"  FAILED  {scenario}\n{traceback.format_exc()}{outcome.said}")
    return failed


if __name__ == "__main__":
    try:
        kernel()
    except NotHere as reason:
        sys.exit(f"The rig cannot run here: {reason}.")
    sys.exit(min(main(sys.argv[1:]), 1))
