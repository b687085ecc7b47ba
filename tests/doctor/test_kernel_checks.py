"""What the kernel allows, judged on machines made for it."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from fraese.doctor.findings import State, ask
from fraese.doctor.kernel import KERNEL_CHECKS
from fraese.motor.realtime.kernel import IdleState, kernel_facts
from tests.doctor.ward import INTERRUPTS, by_name, patient, process, put, sound_machine

CPU = "sys/devices/system/cpu"
ALL_RIGHTS = (1 << 41) - 1


def test_a_sound_machine_has_nothing_to_change(tmp_path: Path) -> None:
    findings = ask(KERNEL_CHECKS, patient(sound_machine(tmp_path)))
    assert [finding.name for finding in findings if finding.state is not State.OK] == []
    assert not any(finding.change for finding in findings)
    assert len(findings) == len(KERNEL_CHECKS)


def test_a_system_that_says_nothing_is_no_error(tmp_path: Path) -> None:
    facts = kernel_facts(50, tmp_path)
    assert (facts.rt_runtime_us, facts.throttle_share) == (None, None)
    assert (facts.cores, facts.governors, facts.idle_states) == ((), (), ())
    assert not facts.may_be_realtime
    assert facts.nicest == 20
    found = by_name(ask(KERNEL_CHECKS, patient(tmp_path)))
    assert found["cores"].state is State.WARN


def no_rights(root: Path) -> None:
    process(root)


def one_core(root: Path) -> None:
    process(root, rights=ALL_RIGHTS, cores="0")


def powersave(root: Path) -> None:
    put(root, f"{CPU}/cpu1/cpufreq/scaling_governor", "powersave\n")


def may_sleep_deeply(root: Path) -> None:
    (root / "dev/cpu_dma_latency").unlink()


def slow_clock(root: Path) -> None:
    put(root, "sys/devices/system/clocksource/clocksource0/current_clocksource", "hpet\n")


def hypervisor(root: Path) -> None:
    put(root, "proc/cpuinfo", "flags\t\t: fpu hypervisor tsc\n")


ILLS = [
    ("real-time scheduling", no_rights, "RTPRIO", "@lp - rtprio 50"),
    ("nice", no_rights, "down to 20", "@lp - nice -20"),
    ("locked memory", no_rights, "8192 KiB at most", "@lp - memlock unlimited"),
    ("autogroup", no_rights, "same share", "sched_autogroup_enabled=0"),
    ("cores", one_core, "One only", "two cores"),
    ("frequency", powersave, "performance, powersave", "frequency-set -g performance"),
    ("idle states", may_sleep_deeply, "C6, 133 us", 'KERNEL=="cpu_dma_latency"'),
    ("clock", slow_clock, "hpet", "clocksource=tsc"),
    ("hypervisor", hypervisor, "virtual machine", "computer of its own"),
]


@pytest.mark.parametrize(("name", "harm", "said", "change"), ILLS)
def test_what_could_delay_the_steps_is_a_warning_that_says_what_to_change(
    tmp_path: Path, name: str, harm: Callable[[Path], None], said: str, change: str
) -> None:
    root = sound_machine(tmp_path)
    harm(root)
    finding = by_name(ask(KERNEL_CHECKS, patient(root)))[name]
    assert finding.state is State.WARN
    assert re.search(said, finding.found), finding.found
    assert change in finding.change


def test_the_right_to_be_nice_is_as_good_as_the_limits(tmp_path: Path) -> None:
    root = sound_machine(tmp_path)
    process(root, rights=ALL_RIGHTS)
    found = by_name(ask(KERNEL_CHECKS, patient(root)))
    for name in ("real-time scheduling", "nice", "locked memory", "autogroup"):
        assert found[name].state is State.OK


def test_throttling_only_hurts_who_never_sleeps(tmp_path: Path) -> None:
    root = sound_machine(tmp_path)
    name = "real-time throttling"
    asleep = by_name(ask(KERNEL_CHECKS, patient(root, sleeps=True)))
    awake = by_name(ask(KERNEL_CHECKS, patient(root, sleeps=False)))
    assert asleep[name].state is State.OK
    assert awake[name].state is State.WARN
    assert "95% of each second" in awake[name].found
    assert "50 ms at a time" in awake[name].found
    assert "sched_rt_runtime_us=-1" in awake[name].change
    put(root, "proc/sys/kernel/sched_rt_runtime_us", "-1\n")
    unlimited = by_name(ask(KERNEL_CHECKS, patient(root, sleeps=False)))
    assert unlimited[name].state is State.OK


def test_who_never_sleeps_needs_no_real_time_but_nice(tmp_path: Path) -> None:
    root = sound_machine(tmp_path)
    process(root, rtprio=50)
    asleep = by_name(ask(KERNEL_CHECKS, patient(root, sleeps=True)))
    awake = by_name(ask(KERNEL_CHECKS, patient(root, sleeps=False)))
    assert (asleep["nice"].state, awake["nice"].state) == (State.OK, State.WARN)
    assert awake["real-time scheduling"].state is State.OK


def test_deep_sleep_that_is_switched_off_does_no_harm(tmp_path: Path) -> None:
    root = sound_machine(tmp_path)
    may_sleep_deeply(root)
    put(root, f"{CPU}/cpu0/cpuidle/state1/disable", "1\n")
    assert kernel_facts(50, root).idle_states[1] == IdleState("C6", 133, used=False)
    found = by_name(ask(KERNEL_CHECKS, patient(root)))
    assert found["idle states"].state is State.OK


def test_a_core_that_is_not_ours_is_named(tmp_path: Path) -> None:
    root = sound_machine(tmp_path)
    finding = by_name(ask(KERNEL_CHECKS, patient(root, realtime={"core": 7})))["cores"]
    assert finding.state is State.WARN
    assert "core 7, which this program may not use" in finding.found


def test_a_busy_core_is_avoided_unless_it_is_named(tmp_path: Path) -> None:
    root = sound_machine(tmp_path)
    put(root, "proc/interrupts", INTERRUPTS.format(first=40, second=200_000))
    chosen = by_name(ask(KERNEL_CHECKS, patient(root)))["cores"]
    assert (chosen.state, chosen.change) == (State.OK, "")
    assert "made on core 0" in chosen.found
    named = by_name(ask(KERNEL_CHECKS, patient(root, realtime={"core": 1})))["cores"]
    assert (named.state, named.change) == (State.WARN, "realtime.core = 0")
    assert "core 1, which has served 200040 interrupts" in named.found
    assert "core 0 only 9" in named.found


def test_a_core_of_ones_own_is_used(tmp_path: Path) -> None:
    root = sound_machine(tmp_path)
    process(root, rights=ALL_RIGHTS, cores="0")
    put(root, f"{CPU}/isolated", "1\n")
    chosen = by_name(ask(KERNEL_CHECKS, patient(root)))["cores"]
    assert (chosen.state, chosen.change) == (State.OK, "")
    assert "core 1 to themselves" in chosen.found
    named = by_name(ask(KERNEL_CHECKS, patient(root, realtime={"core": 0})))["cores"]
    assert (named.state, named.change) == (State.WARN, "realtime.core = 1")


@pytest.mark.parametrize(
    ("awake", "logind", "state"),
    [(True, True, State.OK), (False, True, State.WARN), (False, False, State.OK)],
)
def test_sleep_is_forbidden_or_nobody_would_order_it(
    tmp_path: Path, awake: bool, logind: bool, state: State
) -> None:
    root = sound_machine(tmp_path)
    if not logind:
        (root / "run/dbus/system_bus_socket").unlink()
    assert by_name(ask(KERNEL_CHECKS, patient(root, awake=awake)))["suspend"].state is state


def test_what_this_very_machine_says_can_be_read() -> None:
    facts = kernel_facts(50)
    assert facts.cores
    assert facts.nicest <= 20
