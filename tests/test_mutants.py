"""The table of faults still fits the tree; trying them is ``make mutate``."""

from collections import Counter

import pytest

from bench.mutants.__main__ import main, stale
from bench.mutants.mutant import ROOT, Mutant
from bench.mutants.tables import MUTANTS


def test_every_row_fits_the_tree() -> None:
    assert stale(MUTANTS) == []


def test_no_name_stands_twice() -> None:
    assert [name for name, times in Counter(m.name for m in MUTANTS).items() if times > 1] == []


@pytest.mark.parametrize("mutant", MUTANTS, ids=[m.name for m in MUTANTS])
def test_the_tests_that_a_row_names_are_there(mutant: Mutant) -> None:
    assert mutant.tests
    assert mutant.old != mutant.new
    for test in mutant.tests:
        file, *names = test.split("::")
        text = (ROOT / file).read_text("utf-8")
        assert all(f"def {name}(" in text or f"class {name}:" in text for name in names), test


def test_a_row_whose_line_has_moved_is_called_stale(capsys: pytest.CaptureFixture[str]) -> None:
    row = Mutant("row", "harm", "fraese/errors.py", "no such text", "", ("tests/test_log.py",))
    assert stale([row]) == ["row: 'no such text' is 0 times in fraese/errors.py, not once"]
    assert main(["no row has this in its name"]) == 1
    assert "no row has" in capsys.readouterr().out
