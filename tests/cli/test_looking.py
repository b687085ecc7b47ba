"""A look-through that takes long, on a clock of its own."""

import pytest

from fraese.cli.looking import Looking
from fraese.cli.output import settle
from fraese.program.telling import Stage


@pytest.fixture
def time_s() -> list[float]:
    return [100.0]


def test_nothing_is_said_in_the_first_second(
    time_s: list[float], capsys: pytest.CaptureFixture[str]
) -> None:
    looking = Looking("part.ngc", lambda: time_s[0])
    time_s[0] += 0.9
    looking(Stage(500, line=500))
    looking.done()
    settle()
    assert capsys.readouterr().err == ""


def test_where_nobody_sees_progress_it_is_said_once(
    time_s: list[float], capsys: pytest.CaptureFixture[str]
) -> None:
    looking = Looking("part.ngc", lambda: time_s[0])
    for lines in (500, 900, 1300):
        time_s[0] += 1.1
        looking(Stage(lines, line=lines))
    looking.done()
    settle()
    assert capsys.readouterr().err.splitlines() == [
        "Looking part.ngc through takes a while; it is in line 500."
    ]


def test_a_loop_without_end_is_named_with_its_line(
    time_s: list[float], capsys: pytest.CaptureFixture[str]
) -> None:
    looking = Looking("part.ngc", lambda: time_s[0])
    for _ in range(30):
        time_s[0] += 1
        looking(Stage(40, line=17))
    settle()
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 2
    assert said[1].startswith("part.ngc, line 17: for 10 s it goes round here")
