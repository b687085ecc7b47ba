"""Generated programs: same end points and arcs, same order, same refusals as rs274."""

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings

from tests.judge.compare import SUMMED_TOLERANCE_MM, disagreement
from tests.judge.generated import EXPRESSIONS, PROGRAMS, ROTARY_PROGRAMS
from tests.judge.rs274 import REASON, RS274

pytestmark = pytest.mark.skipif(RS274 is None, reason=REASON)

TOOLS = {1: 12.9794, 2: 3.0}
EXAMPLES = settings(
    max_examples=250,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)


def test_programs(tmp_path: Path) -> None:
    @EXAMPLES
    @given(PROGRAMS)
    def check(text: str) -> None:
        assert not disagreement(text, tmp_path, TOOLS, SUMMED_TOLERANCE_MM)

    check()


def test_programs_with_a_rotary_axis(tmp_path: Path) -> None:
    @EXAMPLES
    @given(ROTARY_PROGRAMS)
    def check(text: str) -> None:
        assert not disagreement(text, tmp_path, TOOLS, SUMMED_TOLERANCE_MM, axes="xyza")

    check()


def test_expressions(tmp_path: Path) -> None:
    @settings(EXAMPLES, max_examples=120)
    @given(EXPRESSIONS)
    def check(text: str) -> None:
        assert not disagreement(text, tmp_path, TOOLS)

    check()
