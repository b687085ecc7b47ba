"""``python -m rigs.lpt [BOOT...]``: run the real-kernel rig and say what held."""

import sys
import time
import traceback
from pathlib import Path
from tempfile import TemporaryDirectory

from rigs.lpt.boots import BOOTS, run
from rigs.lpt.checks import check
from rigs.lpt.kernel import CACHE, NotHere, kernel


def main(names: list[str]) -> int:
    """Run these boots, or all; the number of scenarios that failed."""
    failed = 0
    for name in names or BOOTS:
        with TemporaryDirectory(dir=CACHE) as folder:
            started_s = time.monotonic()
            outcomes = run(BOOTS[name], kernel(), Path(folder))
            print(f"{name}: {time.monotonic() - started_s:.1f} s")
            print(open(folder+"/job.log").read())
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
