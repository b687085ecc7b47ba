"""The ports on a real kernel: the scenarios of the rig, each one test. A boot is shared by many."""

from collections.abc import Callable, Mapping

import pytest

from rigs.lpt.boots import BOOTS, run
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
def booted(debian: Kernel, tmp_path_factory: pytest.TempPathFactory) -> Booted:
    """What came of a boot; each is done once, when it is first asked for."""
    done: dict[str, Mapping[str, Outcome] | BaseException] = {}

    def boot(name: str) -> Mapping[str, Outcome]:
        if BOOTS[name].driven and fakeport.missing():
            pytest.skip(fakeport.missing())
        if name not in done:
            try:
                done[name] = run(BOOTS[name], debian, tmp_path_factory.mktemp("boot"))
            except AssertionError as error:
                done[name] = error
        outcome = done[name]
        if isinstance(outcome, BaseException):
            raise outcome
        return outcome

    return boot


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
