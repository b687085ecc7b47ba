"""Every construct of the language: same moves, same order, same refusals as rs274."""

from pathlib import Path

import pytest

from tests.judge.compare import disagreement
from tests.judge.programs import topics
from tests.judge.rs274 import REASON, RS274

pytestmark = pytest.mark.skipif(RS274 is None, reason=REASON)

TOOLS = {1: 12.9794, 2: 3.0}


@pytest.mark.parametrize("topic", topics())
def test_agrees_with_the_judge(topic: str, tmp_path: Path) -> None:
    wrong = [
        f"{program!r}\n    {said}"
        for program in topics()[topic]
        if (said := disagreement(program, tmp_path, TOOLS))
    ]
    assert not wrong, "\n".join(wrong)
