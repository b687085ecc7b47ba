"""Cutter compensation: the path beside the path, and what is refused, as rs274 has them.

We refuse more in two cases, each with a sentence of its own: a move of which two inside corners
leave less than nothing, where LinuxCNC lets it pass if the second corner is none, and an arc that
leads to the path on the wrong side.
"""

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.judge.compare import differences, our_verdict
from tests.judge.outlines import DIAMETERS, ENTERED_BY_ARC, LENGTHS, outlines
from tests.judge.rs274 import REASON, RS274, judge

pytestmark = pytest.mark.skipif(RS274 is None, reason=REASON)

CASES = Path(__file__).with_name("compensation.txt")
SHIPPED = Path("/usr/share/linuxcnc/ncfiles")
WIDE = {1: 10.0, 2: 4.0, 3: -4.0}
OURS_ALONE = ("this inside corner without gouging", "no such arc leads from here to the path")
EXAMPLES = settings(
    max_examples=60,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)


def cases() -> list[str]:
    lines = CASES.read_text("utf-8").splitlines()
    return [line for line in lines if not line.startswith("#")]


def test_every_case(tmp_path: Path) -> None:
    wrong = []
    for case in cases():
        text = f"g21 f100 g0 x0 y0 z5\n{case.replace('|', chr(10))}\nm2\n"
        tools = dict.fromkeys(WIDE, 0.0)
        ours, theirs = our_verdict(text, tools, WIDE), judge(text, tmp_path, tools, diameters=WIDE)
        if said := differences(ours, theirs):
            wrong.append(f"{case}: {said}")
    assert not wrong, "\n".join(wrong)
    assert len(cases()) > 100


@pytest.mark.skipif(not SHIPPED.is_dir(), reason=f"no sample programs in {SHIPPED}")
@pytest.mark.parametrize("name", ["comp", "comp-g1", "comp311", "comp311_2", "lathecomp"])
@pytest.mark.parametrize("diameter_mm", [0.1, 1.5875, 6.35])
def test_the_programs_of_linuxcnc(tmp_path: Path, name: str, diameter_mm: float) -> None:
    text = (SHIPPED / f"{name}.ngc").read_bytes().decode("latin-1")
    tools, wide = dict.fromkeys(range(1, 100), 0.0), dict.fromkeys(range(1, 100), diameter_mm)
    ours, theirs = our_verdict(text, tools, wide), judge(text, tmp_path, tools, diameters=wide)
    assert not differences(ours, theirs)


@pytest.mark.parametrize(
    "programs", [outlines(17), outlines(18), ENTERED_BY_ARC], ids=["G17", "G18", "entered by arc"]
)
def test_any_outline(tmp_path: Path, programs: st.SearchStrategy[str]) -> None:
    seen = {"agreed": 0, "theirs alone": 0}

    @EXAMPLES
    @given(programs)
    def check(text: str) -> None:
        ours = our_verdict(text, LENGTHS, DIAMETERS)
        theirs = judge(text, tmp_path, LENGTHS, diameters=DIAMETERS)
        if theirs.refused and not ours.refused and "corner" in theirs.refused:
            # An arc that is cut to next to nothing: they decide by another rounding.
            seen["theirs alone"] += 1
            return
        if any(said in ours.refused for said in OURS_ALONE):
            theirs.refused = ours.refused
        assert not differences(ours, theirs), text
        seen["agreed"] += 1

    check()
    assert seen["theirs alone"] <= seen["agreed"] / 50
