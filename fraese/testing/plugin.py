"""Fixtures for pytest: it finds them by the entry point ``fraese``, wherever fraese is installed.

mill_config    what is simulated; a test or a conftest.py puts another one in its place
mill           the machine, commanded by the test
app_size       columns and lines of the app's terminal; likewise
app            the same machine behind the app, keys typed

Rule 1: whoever does not use them does not pay for them: nothing is imported until one is asked for.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from fraese.testing.app import App
    from fraese.testing.mill import Mill


@pytest.fixture
def mill_config() -> Mapping[str, Any] | Path | None:
    """The machine to be simulated: a path of a ``fraese.toml``, or its tables; None: built in."""
    return None


@pytest.fixture
def mill(mill_config: Mapping[str, Any] | Path | None) -> "Iterator[Mill]":
    """A simulated machine in virtual time; see ``fraese.testing.Mill``."""
    from fraese.testing.mill import Mill

    with Mill(mill_config) as made:
        yield made


@pytest.fixture
def app_size() -> tuple[int, int]:
    """Columns and lines of the terminal."""
    return 80, 24


@pytest.fixture
def app(
    mill_config: Mapping[str, Any] | Path | None, app_size: tuple[int, int], tmp_path: Path
) -> "Iterator[App]":
    """The app on a simulated machine in virtual time; see ``fraese.testing.App``."""
    from fraese.testing.app import App

    with App(mill_config, size=app_size, folder=tmp_path) as made:
        yield made
