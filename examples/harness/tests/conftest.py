"""The machine that the macros are for."""

from pathlib import Path

import pytest

MACROS = Path(__file__).parents[1] / "macros"


@pytest.fixture
def mill_config():
    return {
        "run": {"subroutine_folders": [str(MACROS)]},
        "axes": {"x": {"travel_mm": 240}, "y": {"travel_mm": 160}},
    }
