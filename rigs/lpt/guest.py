"""What the guest does: scenarios on a real kernel's parallel port.

    python -m rigs.lpt.guest RESULTS NAME...

For each scenario it says what it saw, as one JSON object in RESULTS. What went over the wire is
judged outside, from the trace; marks show where in it each scenario begins and ends.

A scenario is a function and a row in ``SCENARIOS``; what must be true of it is a row in
``checks.py``; when it runs is a row in ``boots.py``. All three under the same name.
"""

import errno
import json
import os
import signal
import sys
import time
import traceback
from collections.abc import Callable, Mapping
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Final

from fraese.motor.clock import VirtualClock
from fraese.motor.core import MotorCore
from fraese.motor.ports import facts
from fraese.motor.seams import StepDriver
from rigs.lpt import lives
from rigs.lpt.drive import driver_on
from rigs.lpt.tools import (
    END_MARK,
    Here,
    Said,
    insmod,
    mark,
    pins,
    refusal,
    remote,
    rmmod,
    wait_for,
    wait_until_it_moves,
)
from tests.rigs.lpt.play import PORTS, bench_of, core_on, play

#: No scenario takes longer than this, even under emulation on a busy machine.
SCENARIO_S: Final = 60


# --- jobs ----------------------------------------------------------------------------------------


def _core(wiring: str, kind: str) -> MotorCore:
    """In this process, in a time of its own."""
    return core_on(PORTS[kind](), bench_of(wiring).card, VirtualClock())


def job(wiring: str, kind: str) -> Said:
    """A job from claim to release."""
    report = play(_core(wiring, kind), "everything")
    return {"ended": report.ended.value, "position_steps": report.position_steps}


def driven(name: str, made: Callable[[], StepDriver]) -> Said:
    """A long move; somebody outside presses the switch."""
    results = Path(os.environ["TMPDIR"])
    driver = made()
    (results / f"ready {name}").touch()
    wait_for((results / f"go {name}").exists)
    report = play(driver, "straight")
    return {"ended": report.ended.value, "position_steps": report.position_steps}


# --- ways out ------------------------------------------------------------------------------------


def signalled(number: signal.Signals, kind: str) -> Said:
    """A signal while it moves."""
    player = Here().start("tests.rigs.lpt.play", "smc", kind, "endless")
    moving = wait_until_it_moves()
    player.send_signal(number)
    player.communicate()
    return {"moving": moving, "left_on_pins": pins(), "code": player.returncode}


def killed(kind: str) -> Said:
    """kill -9 while it moves; then somebody else takes the port and switches the motors off.

    Nothing guards the player here; what guards the real-time driver is in ``lives.py``.
    """
    said = signalled(signal.SIGKILL, kind)
    _core("smc", kind).close()
    return {**said, "pins_then": pins()}


# --- who may have it -----------------------------------------------------------------------------


def second_program(kind: str) -> Said:
    """Two programs want the same port, one after the other."""
    with remote(kind) as first:
        first.write_data(0x11)
        during = asdict(facts.describe())
        started_s = time.monotonic()
        refused = refusal(kind)
        took_s = time.monotonic() - started_s
        first.write_data(0x12)
        status = first.read_status()
        first.close()
        afterwards = refusal(kind)
    return {
        "refused": refused,
        "took_s": took_s,
        "facts": during,
        "first_pid": first.pid,
        "first_reads": status,
        "afterwards": afterwards,
    }


def careless_claimant() -> Said:
    """Another program claims without asking for the port alone."""
    from fcntl import ioctl

    with remote("ppdev") as first:
        first.write_data(0x21)
        fd = os.open("/dev/parport0", os.O_RDWR)
        try:
            ioctl(fd, 0x708B)
            refused = 0
        except OSError as error:
            refused = error.errno or 0
        first.write_data(0x22)
        os.close(fd)
    return {"refused": errno.errorcode.get(refused, "")}


def printer_driver() -> Said:
    """lp is there first; then it is unloaded; then it comes while the port is ours."""
    insmod("lp")
    held = asdict(facts.describe())
    refused = refusal("ppdev")
    rmmod("lp")
    afterwards = refusal("ppdev")
    with remote("ppdev") as port:
        port.write_data(0x31)
        insmod("lp")
        late = asdict(facts.describe())
        port.write_data(0x32)
    rmmod("lp")
    return {"facts": held, "refused": refused, "afterwards": afterwards, "late": late}


def no_driver() -> Said:
    """ppdev is not loaded."""
    rmmod("ppdev")
    found, refused = asdict(facts.describe()), refusal("ppdev")
    insmod("ppdev")
    return {"facts": found, "refused": refused, "afterwards": refusal("ppdev")}


def drivers_anew() -> Said:
    """What the kernel's own drivers do to the lines when they are loaded."""
    for name in ("ppdev", "parport_pc"):
        rmmod(name)
    for name in ("parport_pc", "ppdev"):
        insmod(name)
    return {"refused": refusal("ppdev")}


def permissions() -> Said:
    """A user without rights; the group may; the user is in it."""
    import grp

    lp = grp.getgrnam("lp").gr_gid
    before = Path("/dev/parport0").stat()
    said = {"roots": _as_nobody("ppdev"), "devport": _as_nobody("devport")}
    os.chown("/dev/parport0", 0, lp)
    os.chmod("/dev/parport0", 0o660)
    said["groups"] = _as_nobody("ppdev")
    said["member"] = _as_nobody("ppdev", lp)
    os.chown("/dev/parport0", before.st_uid, before.st_gid)
    os.chmod("/dev/parport0", before.st_mode & 0o777)
    # Allowed to open the file, but without the right to use I/O ports.
    os.chmod("/dev/port", 0o666)
    said["no right"] = _as_nobody("devport")
    os.chmod("/dev/port", 0o600)
    return said


def _as_nobody(kind: str, *groups: int) -> str:
    """Ask for the port as an ordinary user: in a child that lays root's rights down."""
    reading, writing = os.pipe()
    child = os.fork()
    if not child:
        try:
            os.setgroups(groups)
            os.setgid(65534)
            os.setuid(65534)
            os.write(writing, refusal(kind).encode())
        finally:
            os._exit(0)
    os.close(writing)
    with os.fdopen(reading, "rb") as pipe:
        said = pipe.read().decode()
    os.waitpid(child, 0)
    return said


def lockdown() -> Said:
    """What the kernel refuses, what it lets through."""
    return {"facts": asdict(facts.describe()), "devport": refusal("devport")}


def looked_over(kind: str) -> Said:
    """The doctor looks at port and kernel; how late steps are cannot be told under emulation."""
    from fraese.config.file import from_table
    from fraese.doctor import admit
    from fraese.doctor.findings import ask
    from fraese.doctor.kernel import KERNEL_CHECKS
    from fraese.doctor.port import PORT_CHECKS
    from fraese.kinds.card import card_of

    config = from_table({"port": {"kind": kind}}, "guest")
    patient = admit(config, card_of(config))
    return {
        finding.name: (finding.state.value, finding.found, finding.change)
        for finding in ask((*PORT_CHECKS[kind], *KERNEL_CHECKS), patient)
    }


SCENARIOS: Final[Mapping[str, Callable[[], Said]]] = {
    **{
        f"job, {wiring} on {kind}": partial(job, wiring, kind)
        for wiring in ("smc", "x4step")
        for kind in PORTS
    },
    **{
        f"contact, {wiring} on {kind}": partial(
            driven, f"contact, {wiring} on {kind}", partial(_core, wiring, kind)
        )
        for wiring in ("smc", "x4step")
        for kind in PORTS
    },
    "driver's contact, smc on ppdev": partial(
        driven, "driver's contact, smc on ppdev", partial(driver_on, "smc", "ppdev")
    ),
    "driver's job, smc on ppdev": partial(lives.driver_job, "smc", "ppdev"),
    "kill -9 of the program, ppdev": partial(lives.host_killed, "ppdev"),
    "kill -9 of the step process, devport": partial(lives.step_process_killed, "devport"),
    "SIGTERM on ppdev": partial(signalled, signal.SIGTERM, "ppdev"),
    "SIGTERM on devport": partial(signalled, signal.SIGTERM, "devport"),
    "kill -9 on ppdev": partial(killed, "ppdev"),
    "second program on ppdev": partial(second_program, "ppdev"),
    "second program on devport": partial(second_program, "devport"),
    "careless claimant": careless_claimant,
    "printer driver": printer_driver,
    "no driver": no_driver,
    "drivers loaded anew": drivers_anew,
    "permissions": permissions,
    **{f"looked over, {kind}": partial(looked_over, kind) for kind in PORTS},
    "lockdown": lockdown,
    "locked job, smc on ppdev": partial(job, "smc", "ppdev"),
}


def _within_time(scenario: Callable[[], Said]) -> Said:
    """Do it; whatever goes wrong is its result, and the next one has its turn."""

    def too_long(number: int, frame: object) -> None:
        raise TimeoutError("the scenario takes too long")

    signal.signal(signal.SIGALRM, too_long)
    signal.alarm(SCENARIO_S)
    try:
        return scenario()
    except Exception:
        return {"failed": traceback.format_exc()}
    finally:
        signal.alarm(0)


def main(results: Path, names: list[str]) -> None:
    """Do them in order; each result is one file."""
    for number, name in enumerate(names, 1):
        mark(number)
        said = _within_time(SCENARIOS[name])
        mark(END_MARK)
        (results / f"{name}.json").write_text(json.dumps(said))
        print(f"{name}: {time.monotonic():.1f} s after power-on", flush=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
