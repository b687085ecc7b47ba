"""What the kernel allows and does, as far as it says so in files.

    /proc/self/status, limits         what this process may ask for, and on which cores
    /proc/sys/kernel                  throttling of real-time processes, autogroup
    /sys/devices/system/cpu           frequency governor, idle states
    /sys/devices/system/clocksource   what a look at the time costs

Rule 1: nothing here asks for anything or changes anything.
Rule 2: what cannot be found out is None or empty, never an error: on another system there is
        simply less to say.
Rule 3: ``root`` is where the file system begins; tests bring their own.
"""

import os
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Final

_ROOT: Final = Path("/")
#: From linux/capability.h.
_CAP_IPC_LOCK: Final = 14
_CAP_SYS_NICE: Final = 23
#: ``ulimit -e`` counts from nice 19 downwards.
_NICEST: Final = 20
#: What there is where ``logind`` runs and can be asked; it sends machines to sleep.
_LOGIND: Final = ("run/systemd/seats", "run/dbus/system_bus_socket")
_UNLIMITED: Final = 1 << 62


@dataclass(frozen=True, slots=True)
class IdleState:
    """A way in which a processor sleeps.

    Attributes:
        name: as the kernel calls it.
        wake_us: how long it takes to wake.
        used: it was not switched off.
    """

    name: str
    wake_us: int
    used: bool


@dataclass(frozen=True, slots=True)
class KernelFacts:
    """Everything that decides how late a process may wake.

    Attributes:
        rt_runtime_us: of each ``rt_period_us``, so much belongs to real-time processes; negative:
            all of it; None: unknown.
        rt_period_us: how long a period is.
        may_be_realtime: SCHED_FIFO will be granted.
        nicest: lowest nice value that will be granted.
        lockable_bytes: memory that may be locked.
        autogroup: processes of a session share one weight.
        cores: those that this process may use.
        isolated: those that the kernel keeps free of everything else. They are not among the
            ``cores``, but can be asked for by number.
        governors: frequency governors in use, without repetition.
        idle_states: of the first core.
        may_forbid_idle: /dev/cpu_dma_latency can be written.
        clocksource: where the time comes from.
        is_virtual: there is a hypervisor that takes time when it likes.
        device_interrupts: how many interrupts of devices each core has served since boot.
        has_logind: somebody can be asked not to let the machine sleep.
    """

    rt_runtime_us: int | None
    rt_period_us: int
    may_be_realtime: bool
    nicest: int
    lockable_bytes: int
    autogroup: bool
    cores: tuple[int, ...]
    isolated: tuple[int, ...]
    governors: tuple[str, ...]
    idle_states: tuple[IdleState, ...]
    may_forbid_idle: bool
    clocksource: str
    is_virtual: bool
    device_interrupts: tuple[int, ...]
    has_logind: bool

    @property
    def throttle_share(self) -> float | None:
        """Share of the time that a real-time process may take; None: all of it, or unknown."""
        if self.rt_runtime_us is None or self.rt_runtime_us < 0 or not self.rt_period_us:
            return None
        return self.rt_runtime_us / self.rt_period_us

    @property
    def slowest_wake_us(self) -> int:
        """Of the idle states in use."""
        return max((state.wake_us for state in self.idle_states if state.used), default=0)


def kernel_facts(priority: int, root: Path = _ROOT) -> KernelFacts:
    """Look the system over.

    Args:
        priority: SCHED_FIFO priority that will be wanted.
        root: where the file system begins.
    """
    status = _fields(root / "proc/self/status")
    rights = int(status.get("CapEff", "0"), 16)
    kernel, processors = root / "proc/sys/kernel", root / "sys/devices/system/cpu"
    may_nice = bool(rights >> _CAP_SYS_NICE & 1)
    return KernelFacts(
        rt_runtime_us=_number(kernel / "sched_rt_runtime_us"),
        rt_period_us=_number(kernel / "sched_rt_period_us") or 1_000_000,
        may_be_realtime=may_nice or _limit(root, "Max realtime priority") >= priority,
        nicest=-_NICEST if may_nice else _NICEST - _limit(root, "Max nice priority"),
        lockable_bytes=(
            _UNLIMITED if rights >> _CAP_IPC_LOCK & 1 else _limit(root, "Max locked memory")
        ),
        autogroup=_number(kernel / "sched_autogroup_enabled") == 1,
        cores=_numbers(status.get("Cpus_allowed_list", "")),
        isolated=_numbers(_text(processors / "isolated")),
        governors=_governors(processors),
        idle_states=_idle_states(processors / "cpu0/cpuidle"),
        may_forbid_idle=os.access(root / "dev/cpu_dma_latency", os.W_OK),
        clocksource=_text(root / "sys/devices/system/clocksource/clocksource0/current_clocksource"),
        is_virtual=bool(
            re.search(r"^flags\s*:.*\bhypervisor\b", _text(root / "proc/cpuinfo"), re.M)
        ),
        device_interrupts=_device_interrupts(root),
        has_logind=all((root / path).exists() for path in _LOGIND),
    )


# --- what may fail, and then says nothing --------------------------------------------------------


def _text(path: Path) -> str:
    try:
        return path.read_text("utf-8", "replace").strip()
    except OSError:
        return ""


def _number(path: Path) -> int | None:
    try:
        return int(_text(path))
    except ValueError:
        return None


def _fields(path: Path) -> dict[str, str]:
    """Lines of "name: value"."""
    parts = (line.partition(":") for line in _text(path).splitlines())
    return {name: value.strip() for name, _, value in parts}


def _limit(root: Path, name: str) -> int:
    """The soft limit of that name; 0 where there is none to be seen."""
    found = re.search(rf"^{name}\s+(\w+)", _text(root / "proc/self/limits"), re.M)
    if not found:
        return 0
    return _UNLIMITED if found[1] == "unlimited" else int(found[1])


def _numbers(ranges: str) -> tuple[int, ...]:
    """As in "0-2,5"."""
    found: list[int] = []
    for first, last in re.findall(r"(\d+)(?:-(\d+))?", ranges):
        found += range(int(first), int(last or first) + 1)
    return tuple(found)


def _governors(processors: Path) -> tuple[str, ...]:
    files = sorted(processors.glob("cpu[0-9]*/cpufreq/scaling_governor"))
    return tuple(dict.fromkeys(filter(None, map(_text, files))))


def _idle_states(folder: Path) -> tuple[IdleState, ...]:
    return tuple(
        IdleState(
            _text(state / "name") or state.name,
            _number(state / "latency") or 0,
            used=_number(state / "disable") != 1,
        )
        for state in sorted(folder.glob("state[0-9]*"))
    )


def _device_interrupts(root: Path) -> tuple[int, ...]:
    """Sums over the numbered lines of /proc/interrupts: one column a core."""
    lines = _text(root / "proc/interrupts").splitlines()
    cores = len(lines[0].split()) if lines else 0
    sums = [0] * cores
    for line in lines[1:]:
        name, _, rest = line.partition(":")
        counts = rest.split()[:cores]
        if name.strip().isdecimal() and len(counts) == cores:
            sums = [old + int(count) for old, count in zip(sums, counts, strict=True)]
    return tuple(sums)
