"""Every construct of the language: same moves, same order, same refusals as rs274."""

from pathlib import Path

import pytest

from tests.judge.compare import disagreement
from tests.judge.programs import topics, topics_of_more_axes
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


@pytest.mark.parametrize("topic", topics_of_more_axes())
def test_agrees_with_the_judge_on_more_axes(topic: str, tmp_path: Path) -> None:
    axes = topic.split()[0]
    wrong = [
        f"{program!r}\n    {said}"
        for program in topics_of_more_axes()[topic]
        if (said := disagreement(program, tmp_path, TOOLS, axes=axes))
    ]
    assert not wrong, "\n".join(wrong)
