"""The frame of the campaign: what is counted, and that an attempt can be made again."""

import json
from collections import Counter
from dataclasses import replace
from typing import Any

import pytest

from bench.campaign import __main__ as command
from bench.campaign.claims import Claim, claim_of
from bench.campaign.frame import Attempt, Kind, Late, Outcome, campaign
from bench.campaign.kinds import KINDS
from tests.rigs.lpt.shop import Answer


def kind(attempt: object) -> Kind:
    assert callable(attempt)
    return Kind("a fault", "steps", attempt)


def test_attempts_that_missed_are_made_up_for() -> None:
    row = campaign(kind(lambda a: Outcome(figure=a.number, missed=a.number % 2 == 0)), tries=3)
    assert (row.tries, row.unaccounted, row.figures) == (3, 0, [1, 3, 5])


def test_what_always_misses_comes_to_an_end_and_shows_it() -> None:
    row = campaign(kind(lambda _: Outcome(missed=True)), tries=4)
    assert (row.tries, row.figures) == (0, [])


def test_steps_beyond_the_claim_and_errors_are_unaccounted_for() -> None:
    def attempt(given: Attempt) -> Outcome:
        assert given.number != 1, "it hung"
        return Outcome(unaccounted=7 * (given.number == 2), figure=1, note="true 7")

    row = campaign(kind(attempt), tries=4)
    assert (row.tries, row.unaccounted) == (4, 2)
    assert [number for number, _ in row.complaints] == [1, 2]
    assert "it hung" in row.complaints[0][1]
    assert row.complaints[1][1] == "7 (true 7)"


def test_chance_follows_from_seed_kind_and_number_however_many_run_at_once() -> None:
    def attempt(given: Attempt) -> Outcome:
        assert given.folder.is_dir()
        return Outcome(figure=given.random.random())

    row = campaign(kind(attempt), tries=6, seed=4)
    assert row.figures == campaign(kind(attempt), tries=6, seed=4, jobs=3).figures
    assert row.figures != campaign(kind(attempt), tries=6, seed=5).figures
    assert len(set(row.figures)) == 6


def test_what_was_late_is_tried_again_and_late_each_time_is_unaccounted_for() -> None:
    tried: Counter[int] = Counter()

    def attempt(given: Attempt) -> Outcome:
        tried[given.number] += 1
        if tried[given.number] <= 2 * given.number:
            raise Late("braked only after 3 s")
        return Outcome(figure=given.number)

    row = campaign(kind(attempt), tries=3)
    assert (row.tries, row.unaccounted, row.repeated) == (3, 1, 2)
    assert row.figures == [0, 1]
    assert tried == {0: 1, 1: 3, 2: 3}
    assert row.complaints == [(2, "1 (late each time: braked only after 3 s)")]


def test_kinds_are_tried_in_turns_and_the_table_is_complete(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    tried = []

    def told(name: str) -> Kind:
        def attempt(_: Attempt) -> Outcome:
            tried.append(name)
            return Outcome(figure=1)

        return Kind(name, "steps", attempt, many=3)

    kinds = (told("one"), told("another"), replace(told("none"), missing=lambda: "no gcc"))
    monkeypatch.setattr(command, "KINDS", kinds)
    assert command.main(["--round", "2"]) == 0
    assert tried == ["one", "one", "another", "another", "one", "another"]
    said = capsys.readouterr()
    assert said.out.splitlines()[2:] == [
        "| one | 3 | 0 | 1 | 1 | steps |",
        "| another | 3 | 0 | 1 | 1 | steps |",
        "| none | 0 | - | - | - | no gcc |",
    ]
    assert "2 of 3: | one" in said.err


def test_a_row_says_kind_tries_unaccounted_median_and_worst() -> None:
    row = campaign(kind(lambda a: Outcome(figure=a.number)), tries=4)
    assert str(row) == "| a fault | 4 | 0 | 1.5 | 3 | steps |"


def test_every_kind_has_a_name_of_its_own() -> None:
    assert max(Counter(kind.name for kind in KINDS).values()) == 1


def said(doubt: dict[str, Any] | None) -> Claim:
    result = {"position_steps": {"x": 5, "y": -7}, "doubt": doubt}
    return claim_of(Answer(0, json.dumps(result), ""))


def test_a_place_without_doubt_is_claimed_to_the_step() -> None:
    claim = said(None)
    assert claim.is_to_the_step
    assert claim.width_steps == 0
    assert claim.beyond_steps((5, -7)) == 0
    assert claim.beyond_steps((6, -9)) == 3


def test_between_bounds_is_right_if_the_truth_lies_within() -> None:
    bounds = {"low_steps": {"x": 4, "y": -7}, "high_steps": {"x": 5, "y": 493}}
    claim = said({"why": "it ended", **bounds})
    assert not claim.is_to_the_step
    assert [claim.beyond_steps(true) for true in ((4, -7), (5, 493), (3, 495))] == [0, 0, 3]
    # The widest axis: at 2000 steps a second a quarter of a second.
    assert claim.width_s(2000) == pytest.approx(0.25)


def test_who_knows_nothing_claims_nothing() -> None:
    claim = said({"why": "damaged", "low_steps": None, "high_steps": None})
    assert (claim.low_steps, claim.is_to_the_step, claim.beyond_steps((9, 9))) == (None, False, 0)
