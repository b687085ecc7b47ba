"""Does the system let the step process be on time? A table of checks.

Rule 1: nothing here is bad by itself: whether the steps are on time is measured (``timing.py``).
        What could make them late is a warning, and says how to take it away.
Rule 2: who can sleep between two edges needs SCHED_FIFO; who cannot needs nice -20, since a
        real-time process that never sleeps is stopped by the kernel's throttling.
"""

from collections.abc import Sequence
from typing import Final

from fraese.doctor.findings import Check, Finding, Patient, State
from fraese.motor.realtime.cores import core_for_steps, quietest_core
from fraese.motor.realtime.kernel import KernelFacts
from fraese.phrases import phrase

_NICE_WANTED: Final = -20
#: What the step process locks, with room to spare, bytes.
_LOCKED_BYTES: Final = 256 << 20
#: A processor that wakes later than this makes ticks late that are waited for asleep, us.
_WAKE_US: Final = 20
_LIMITS: Final = "/etc/security/limits.d/fraese.conf"
#: A clock that needs a bus cycle costs a microsecond a look, and the loop looks all the time.
_FAST_CLOCKS: Final = ("tsc", "kvm-clock", "arch_sys_counter", "hyperv_clocksource_tsc_page")
_FAST_GOVERNORS: Final = frozenset({"performance"})


def _limits(item: str, value: str) -> str:
    return phrase(
        "Write @lp - {item} {value} into {limits} (lp: a group of yours) and log in again.",
        item=item,
        value=value,
        limits=_LIMITS,
    )


def _realtime(patient: Patient) -> Finding:
    name = phrase("real-time scheduling")
    if not patient.sleeps:
        return Finding(
            name,
            State.OK,
            phrase(
                "Not wanted: at the configured rates the step process never sleeps, and runs"
                " with nice -20."
            ),
        )
    if patient.kernel.may_be_realtime:
        return Finding(name, State.OK, phrase("Allowed: the step process runs under SCHED_FIFO."))
    return Finding(
        name,
        State.WARN,
        phrase("Not allowed (RLIMIT_RTPRIO is too low): other programs delay the steps."),
        _limits("rtprio", "50"),
    )


def _throttling(patient: Patient) -> Finding:
    name, share = phrase("real-time throttling"), patient.kernel.throttle_share
    if share is None:
        return Finding(name, State.OK, phrase("Off, or not known to this kernel."))
    stopped_ms = (1 - share) * patient.kernel.rt_period_us / 1000
    held = phrase(
        "Real-time processes get {share:.0%} of each second (sched_rt_runtime_us)", share=share
    )
    if patient.sleeps:
        return Finding(
            name,
            State.OK,
            phrase(
                "{held}: harmless, the configured rates leave the step process time to sleep.",
                held=held,
            ),
        )
    return Finding(
        name,
        State.WARN,
        phrase(
            "{held}: the configured rates leave no time to sleep, and SCHED_FIFO would be"
            " stopped for {stopped_ms:.0f} ms at a time. So it is not used.",
            held=held,
            stopped_ms=stopped_ms,
        ),
        phrase(
            "With a core to spare: sudo sysctl kernel.sched_rt_runtime_us=-1. Or lower"
            " axes.*.max_rate_hz."
        ),
    )


def _nice(patient: Patient) -> Finding:
    nicest = patient.kernel.nicest
    if nicest <= _NICE_WANTED:
        return Finding(
            phrase("nice"), State.OK, phrase("Down to {nicest} is allowed.", nicest=nicest)
        )
    needed = not (patient.sleeps and patient.kernel.may_be_realtime)
    return Finding(
        phrase("nice"),
        State.WARN if needed else State.OK,
        phrase("Only down to {nicest} is allowed (RLIMIT_NICE).", nicest=nicest),
        _limits("nice", str(_NICE_WANTED)) if needed else "",
    )


def _memory(patient: Patient) -> Finding:
    lockable = patient.kernel.lockable_bytes
    if lockable >= _LOCKED_BYTES:
        return Finding(
            phrase("locked memory"), State.OK, phrase("As much as the step process needs.")
        )
    return Finding(
        phrase("locked memory"),
        State.WARN,
        phrase(
            "{lockable} KiB at most (RLIMIT_MEMLOCK): the step process may have to wait for"
            " the disk.",
            lockable=lockable >> 10,
        ),
        _limits("memlock", "unlimited"),
    )


def _autogroup(patient: Patient) -> Finding:
    kernel = patient.kernel
    if not kernel.autogroup:
        return Finding(phrase("autogroup"), State.OK, "Off.")
    if kernel.nicest <= _NICE_WANTED or (patient.sleeps and kernel.may_be_realtime):
        return Finding(
            phrase("autogroup"), State.OK, phrase("On; the step process' own group comes first.")
        )
    return Finding(
        phrase("autogroup"),
        State.WARN,
        phrase("On: each session gets the same share, however nice its processes are."),
        phrase("sudo sysctl kernel.sched_autogroup_enabled=0"),
    )


def _cores(patient: Patient) -> Finding:
    kernel = patient.kernel
    mine = core_for_steps(patient.config.realtime.core, kernel)
    usable = sorted({*kernel.cores, *kernel.isolated})
    quietest, served = quietest_core(kernel), kernel.device_interrupts
    if len(usable) < 2:
        return Finding(
            phrase("cores"),
            State.WARN,
            phrase("One only: the steps share it with the display and all else."),
            phrase("Use a computer with two cores or more, or keep the step rates low."),
        )
    if mine not in usable:
        return Finding(
            phrase("cores"),
            State.WARN,
            phrase("realtime.core names core {mine}, which this program may not use.", mine=mine),
            phrase("Name one of {usable}, or none.", usable=", ".join(map(str, usable))),
        )
    if kernel.isolated:
        return _isolated(kernel, mine)
    if quietest is not None and mine != quietest:
        return Finding(
            phrase("cores"),
            State.WARN,
            phrase(
                "{count}; the steps are made on core {mine}, which has served {served}"
                " interrupts of devices since boot, core {quietest} only {served_2}.",
                count=len(usable),
                mine=mine,
                served=served[mine],
                quietest=quietest,
                served_2=served[quietest],
            ),
            f"realtime.core = {quietest}",
        )
    return Finding(
        phrase("cores"),
        State.OK,
        phrase("{count}; the steps are made on core {mine}.", count=len(usable), mine=mine),
    )


def _isolated(kernel: KernelFacts, mine: int) -> Finding:
    if mine in kernel.isolated:
        return Finding(
            phrase("cores"),
            State.OK,
            phrase("The steps have core {mine} to themselves (isolcpus).", mine=mine),
        )
    free = kernel.isolated[-1]
    return Finding(
        phrase("cores"),
        State.WARN,
        phrase(
            "Core {free} is kept free of all else, but the steps are made on core {mine}.",
            free=free,
            mine=mine,
        ),
        f"realtime.core = {free}",
    )


def _governor(patient: Patient) -> Finding:
    governors = patient.kernel.governors
    if not governors:
        return Finding(phrase("frequency"), State.OK, phrase("The kernel does not change it."))
    if set(governors) <= _FAST_GOVERNORS:
        return Finding(
            phrase("frequency"), State.OK, phrase("Governor performance: always the full one.")
        )
    return Finding(
        phrase("frequency"),
        State.WARN,
        phrase(
            "Governor {governors}: the processor may be slow when a tick comes.",
            governors=", ".join(governors),
        ),
        phrase("sudo cpupower frequency-set -g performance"),
    )


def _idle(patient: Patient) -> Finding:
    kernel = patient.kernel
    if not kernel.idle_states:
        return Finding(phrase("idle states"), State.OK, phrase("The kernel does not manage any."))
    deepest = max(kernel.idle_states, key=lambda state: state.wake_us)
    found = phrase(
        "Deepest {name}, {wake_us} us to wake", name=deepest.name, wake_us=deepest.wake_us
    )
    if kernel.may_forbid_idle:
        return Finding(
            phrase("idle states"),
            State.OK,
            phrase("{found}; forbidden while steps are made (cpu_dma_latency).", found=found),
        )
    if kernel.slowest_wake_us <= _WAKE_US:
        return Finding(
            phrase("idle states"),
            State.OK,
            phrase("{found}; the slow ones are switched off.", found=found),
        )
    return Finding(
        phrase("idle states"),
        State.WARN,
        phrase(
            "{found}, and this user may not forbid it: /dev/cpu_dma_latency cannot be written.",
            found=found,
        ),
        phrase(
            'Write KERNEL=="cpu_dma_latency", GROUP="lp", MODE="0660" into'
            " /etc/udev/rules.d/60-fraese.rules and start the computer anew."
        ),
    )


def _clock(patient: Patient) -> Finding:
    source = patient.kernel.clocksource
    if not source or source in _FAST_CLOCKS:
        return Finding(phrase("clock"), State.OK, f"{source or 'Unknown'}.")
    return Finding(
        phrase("clock"),
        State.WARN,
        phrase("{source}: every look at the time goes over a bus.", source=source),
        phrase("Boot with clocksource=tsc tsc=reliable, if the processor's own clock is sound."),
    )


def _hypervisor(patient: Patient) -> Finding:
    if not patient.kernel.is_virtual:
        return Finding(
            phrase("hypervisor"), State.OK, phrase("None: the processor belongs to this system.")
        )
    return Finding(
        phrase("hypervisor"),
        State.WARN,
        phrase(
            "This is a virtual machine: its host takes the processor away when it likes, and"
            " nothing here can forbid it."
        ),
        phrase("Drive steel from a computer of its own."),
    )


def _suspend(patient: Patient) -> Finding:
    kernel = patient.kernel
    if patient.awake:
        return Finding(
            phrase("suspend"),
            State.OK,
            phrase("Forbidden while the port is open (systemd-inhibit)."),
        )
    if not kernel.has_logind:
        return Finding(
            phrase("suspend"),
            State.OK,
            phrase(
                "Nobody here would send the machine to sleep (no logind); {awake_note}.",
                awake_note=patient.awake_note,
            ),
        )
    return Finding(
        phrase("suspend"),
        State.WARN,
        phrase("Not forbidden while the motors move: {awake_note}.", awake_note=patient.awake_note),
        phrase("sudo systemctl mask sleep.target suspend.target, or switch it off in the desktop."),
    )


KERNEL_CHECKS: Final[Sequence[Check]] = (
    _realtime, _throttling, _nice, _memory, _autogroup, _cores, _governor, _idle, _clock,
    _hypervisor, _suspend,
)  # fmt: skip
