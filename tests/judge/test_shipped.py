"""The sample programs that LinuxCNC ships: everything that three axes can do must agree."""

from pathlib import Path

import pytest

from tests.judge.compare import SUMMED_TOLERANCE_MM, differences, our_verdict
from tests.judge.rs274 import REASON, RS274, judge

SHIPPED = Path("/usr/share/linuxcnc/ncfiles")
# What other machines can do; the message names it.
NOT_FOR_US = ("is refused:", "there is no axis", "is not a known code")
# We take a file without M2 to its end.
WITHOUT_END = "File ended with no percent sign or program end"

pytestmark = [
    pytest.mark.skipif(RS274 is None, reason=REASON),
    pytest.mark.skipif(not SHIPPED.is_dir(), reason=f"no sample programs in {SHIPPED}"),
]


def test_shipped_programs(tmp_path: Path) -> None:
    tools = dict.fromkeys(range(1, 100), 0.0)
    wrong = []
    judged = 0
    for path in sorted(SHIPPED.rglob("*.ngc")):
        text = path.read_bytes().decode("latin-1")
        ours = our_verdict(text, tools)
        if any(said in ours.refused for said in NOT_FOR_US):
            continue
        theirs = judge(text, tmp_path, tools)
        if WITHOUT_END in theirs.refused:
            continue
        judged += 1
        if said := differences(ours, theirs, SUMMED_TOLERANCE_MM):
            wrong.append(f"{path.name}: {said}")
    assert not wrong, "\n".join(wrong)
    assert judged > 20
