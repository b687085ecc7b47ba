"""The ports on a real kernel: the scenarios of the rig, each one test. A boot is shared by many."""

from collections.abc import Callable, Iterator, Mapping

import pytest

from rigs.lpt.boots import BOOTS, at_once
from rigs.lpt.checks import CHECKS, Outcome, check
from rigs.lpt.guest import SCENARIOS
from rigs.lpt.kernel import Kernel, NotHere, kernel
from tests.rigs.lpt import fakeport

NAMES = [(boot, name) for boot, what in BOOTS.items() for name in what.scenarios]

Booted = Callable[[str], Mapping[str, Outcome]]


@pytest.fixture(scope="module")
def debian() -> Kernel:
    try:
        return kernel()
    except NotHere as reason:
        pytest.skip(str(reason))


@pytest.fixture(scope="module")
def booted(
    debian: Kernel, request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Booted]:
    """What came of a boot: all that are asked for run at once."""
    asked = {
        str(item.callspec.params["boot"])
        for item in request.session.items
        if isinstance(item, pytest.Function) and item.originalname == test_scenario.__name__
    }
    names = [name for name in asked if not (BOOTS[name].driven and fakeport.missing())]
    with at_once(names, debian, tmp_path_factory.mktemp("boots")) as booting:

        def outcomes(name: str) -> Mapping[str, Outcome]:
            if name not in booting:
                pytest.skip(fakeport.missing())
            return booting[name].result()

        yield outcomes


def test_what_is_missing_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("shutil.which", lambda command: None)
    with pytest.raises(NotHere, match=r"qemu-system-x86 busybox-static cpio|needs Linux on x86_64"):
        kernel()
    assert "apt-get install" in fakeport.missing() or "needs Linux" in fakeport.missing()


def test_every_scenario_has_its_check_and_its_boot() -> None:
    assert set(SCENARIOS) == set(CHECKS) == {name for _, name in NAMES}
    assert len(NAMES) == len(SCENARIOS)


@pytest.mark.parametrize(("boot", "name"), NAMES, ids=[name for _, name in NAMES])
def test_scenario(booted: Booted, boot: str, name: str) -> None:
    check(name, booted(boot)[name])
