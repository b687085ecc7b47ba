"""The app in German: no picture shows a sentence of the catalogue in English."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("size", [(80, 24), (120, 40), (200, 60)])
def test_every_view_and_dialog_is_german(tmp_path: Path, size: tuple[int, int]) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "tests.ui.german", *map(str, size)],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT), "HOME": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert len(found) > 10
    assert {picture: said for picture, said in found.items() if said} == {}
