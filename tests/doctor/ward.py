"""Patients for the checks: file systems of machines in good and bad health."""

from pathlib import Path
from typing import Any

from fraese.config import Config
from fraese.doctor.findings import Finding, Patient
from fraese.doctor.opening import Opening
from fraese.kinds.card import card_of
from fraese.motor.ports.facts import describe, status_lines
from fraese.motor.ports.null import NullPort
from fraese.motor.realtime.kernel import kernel_facts
from fraese.motor.realtime.system import PRIORITY
from tests.helpers import configured

PPDEV: dict[str, Any] = {"port": {"kind": "ppdev"}}
DEVPORT: dict[str, Any] = {"port": {"kind": "devport"}}

#: No rights, no limits lifted: an ordinary user's process on two cores.
STATUS = "Name:\tpython3\nCapEff:\t{rights:016x}\nCpus_allowed_list:\t{cores}\n"
LIMITS = """Limit                     Soft Limit           Hard Limit           Units
Max locked memory         {memory}              {memory}              bytes
Max nice priority         {nice}                    {nice}
Max realtime priority     {rtprio}                    {rtprio}
"""
INTERRUPTS = """           CPU0       CPU1
  1:         9          {first}   IO-APIC   1-edge      i8042
 38:         0          {second}  PCI-MSIX  1-edge      nvme0q1
LOC:   1825898    3077697   Local timer interrupts
"""


def put(root: Path, path: str, text: str = "") -> None:
    place = root / path
    place.parent.mkdir(parents=True, exist_ok=True)
    place.write_text(text)


def process(
    root: Path, rights: int = 0, cores: str = "0-1", memory: object = 8388608, nice: int = 0,
    rtprio: int = 0,
) -> None:  # fmt: skip
    """What this process may do there."""
    put(root, "proc/self/status", STATUS.format(rights=rights, cores=cores))
    put(root, "proc/self/limits", LIMITS.format(memory=memory, nice=nice, rtprio=rtprio))


def sound_machine(root: Path) -> Path:
    """A workshop's computer with a port, all that helps granted."""
    process(root, memory="unlimited", nice=40, rtprio=50)
    put(root, "proc/sys/kernel/sched_rt_runtime_us", "950000\n")
    put(root, "proc/sys/kernel/sched_rt_period_us", "1000000\n")
    put(root, "proc/sys/kernel/sched_autogroup_enabled", "1\n")
    put(root, "proc/cpuinfo", "processor\t: 0\nflags\t\t: fpu tsc msr\n")
    put(root, "proc/interrupts", INTERRUPTS.format(first=40, second=100))
    put(root, "proc/modules", "ppdev 24576 0 - Live 0x0\nparport_pc 40960 0 - Live 0x0\n")
    put(root, "sys/devices/system/clocksource/clocksource0/current_clocksource", "tsc\n")
    put(root, "sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "performance\n")
    put(root, "sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "performance\n")
    put(root, "sys/devices/system/cpu/cpu0/cpuidle/state0/name", "POLL\n")
    put(root, "sys/devices/system/cpu/cpu0/cpuidle/state0/latency", "0\n")
    put(root, "sys/devices/system/cpu/cpu0/cpuidle/state1/name", "C6\n")
    put(root, "sys/devices/system/cpu/cpu0/cpuidle/state1/latency", "133\n")
    put(root, "sys/kernel/security/lockdown", "[none] integrity confidentiality\n")
    put(root, "sys/power/state", "freeze mem disk\n")
    put(root, "run/systemd/seats/seat0")
    put(root, "run/dbus/system_bus_socket")
    for device in ("parport0", "port", "cpu_dma_latency"):
        put(root, f"dev/{device}")
    return root


def opened() -> Opening:
    """A port that could be opened, with nothing pressed."""
    return Opening(lines=status_lines(Unpressed()), pins=((1, True), (2, False)))


class Unpressed(NullPort):
    """A plug with all switches open."""

    def read_status(self) -> int:
        return 0xF8


def patient(
    root: Path, *, opening: Opening | None = None, sleeps: bool = True, awake: bool = True,
    **sections: Any,
) -> Patient:  # fmt: skip
    """Who stands on that machine, before the checks."""
    config: Config = configured(**{**PPDEV, **sections})
    return Patient(
        config=config,
        card=card_of(config),
        port=describe(config.port.parallel_device, root),
        opening=opening or opened(),
        kernel=kernel_facts(PRIORITY, root),
        sleeps=sleeps,
        awake=awake,
        awake_note="asked",
    )


def by_name(findings: list[Finding]) -> dict[str, Finding]:
    """Each finding by what was looked at."""
    found = {finding.name: finding for finding in findings}
    assert len(found) == len(findings), "two findings of one name"
    return found
