"""The same program gives the same bytes in both forms: every access to a register, and its time."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from fraese.compiled import FORM, Form

ROOT = Path(__file__).parents[2]


def _corpus(plain: str) -> "subprocess.Popen[str]":
    return subprocess.Popen(
        [sys.executable, "-m", "tests.compiled.corpus"],
        cwd=ROOT,
        env={**os.environ, "FRAESE_PLAIN": plain},
        stdout=subprocess.PIPE,
        text=True,
    )


def _answer(process: "subprocess.Popen[str]") -> dict[str, Any]:
    said, _ = process.communicate()
    assert process.returncode == 0
    found: dict[str, Any] = json.loads(said)
    return found


@pytest.mark.skipif(FORM is not Form.COMPILED, reason="nothing is compiled here: make compiled")
def test_a_corpus_of_programs_writes_the_same_in_both_forms() -> None:
    compiled, plain = map(_answer, [_corpus(""), _corpus("1")])
    assert (compiled["form"], plain["form"]) == ("compiled", "wanted")
    # Many of them move something.
    moved = [said for said in plain["written"].values() if int(said.split()[-2]) > 1000]
    assert len(moved) > 60
    assert compiled["written"] == plain["written"]
