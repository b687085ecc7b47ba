"""Real senders drive the simulated mill, where they are installed; ``make senders`` has all."""

from pathlib import Path

import pytest

from rigs.senders.__main__ import SENDERS, judge, missing

#: Enough to hold and reset in the middle.
_LINES = 1_500


@pytest.mark.parametrize("name", SENDERS)
def test_a_real_sender_drives_the_mill(name: str, tmp_path: Path) -> None:
    if absent := missing(name):
        pytest.skip(f"not installed: {', '.join(absent)}")
    found = judge(name, tmp_path, _LINES)
    assert found["lines"] == _LINES
