"""Settings for every test: property tests are modest and repeatable.

Tests that start processes in real time come by themselves, two at a time at most (marker
``alone``); of all others several may run at once (``pytest -n 3 -m "not alone"``).
"""

import os
import signal
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

#: Folders of tests in which processes or terminals run in real time, in most of their files.
_ALONE = ("doctor", "realtime", "rigs")
#: The same, in other folders.
_ALONE_FILES = (
    "bridge/test_stack.py",
    "cli/test_session.py",
    "contracts/test_clock.py",
    "contracts/test_port.py",
    "control/test_worker.py",
    "ui/test_stopkey.py",
)
#: And where the step process is one peer of several.
_ALONE_PEER = "child on"
_HERE = Path(__file__).parent

settings.register_profile(
    "fraese",
    derandomize=True,
    deadline=None,
    database=None,
    max_examples=60,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("fraese")


# Tests read English, whoever runs them.
os.environ["FRAESE_LANGUAGE"] = "en"

# What a shell without job control starts in the background has SIGINT and SIGQUIT ignored, what
# runs under nohup SIGHUP, and so would every program that the tests start: none would hear the
# signal that it is sent.
for _number, _handler in (
    (signal.SIGINT, signal.default_int_handler),
    (signal.SIGQUIT, signal.SIG_DFL),
    (signal.SIGHUP, signal.SIG_DFL),
):
    if signal.getsignal(_number) is signal.SIG_IGN:
        signal.signal(_number, _handler)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark who must be alone."""
    for item in items:
        path = item.path.relative_to(_HERE)
        alone = path.parts[0] in _ALONE or path.as_posix() in _ALONE_FILES
        if alone or _ALONE_PEER in item.name:
            item.add_marker(pytest.mark.alone)
