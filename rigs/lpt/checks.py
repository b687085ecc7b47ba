"""What must be true of each scenario, judged from outside the guest.

Order, counts and bytes are judged, and medians of times; never the longest time: the guest is
emulated, on a machine that does other things too.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Final

from fraese.motor.seams import CONTROL, DATA
from rigs.lpt.machine import MARK, Access
from tests.rigs.lpt.fakeport import CONTACT
from tests.rigs.lpt.play import simulated_writes
from tests.rigs.lpt.steps import (
    MOTORS_OFF,
    check_contact,
    check_motors_off,
    data_bytes,
    steps_made,
)

Writes = Sequence[tuple[int, int]]

#: What the kernel itself writes: control at rest. DB25 pins 1, 14 and 16 are high then, 17 is low.
AT_REST: Final = (CONTROL, 0x0C)
#: A claim puts control to rest, twice, before anything else.
CLAIM: Final = [AT_REST] * 2


@dataclass(frozen=True)
class Outcome:
    """One scenario from both sides.

    Attributes:
        said: by the guest.
        accesses: to the emulated port, from mark to mark.
    """

    said: Mapping[str, Any]
    accesses: Sequence[Access]

    def writes(self) -> list[tuple[int, int]]:
        """Registers and values, control without the kernel's bits."""
        return [
            (a.register, a.value & 0x0F if a.register == CONTROL else a.value)
            for a in self.accesses
            if a.is_write and a.register != MARK
        ]

    def data(self) -> list[int]:
        """What was on the data lines, one after the other."""
        return data_bytes(self.writes())


def job(wiring: str, kind: str, outcome: Outcome) -> None:
    """Byte for byte, in order, what the simulated mill's registers get from the same blocks."""
    assert outcome.said == {"ended": "target", "position_steps": [117, 105, 62]}
    written = outcome.writes()
    if kind == "ppdev":
        claim, written = written[: len(CLAIM)], written[len(CLAIM) :]
        assert claim == CLAIM
    assert written == simulated_writes(wiring, "everything")
    # Interrupt and direction bits stay as they are.
    controls = [a.value for a in outcome.accesses if a.is_write and a.register == CONTROL]
    assert len({value & ~0x0F for value in controls}) == 1


def job_without_marks(wiring: str, outcome: Outcome) -> None:
    """The same where the kernel refuses the marks: it is the last thing that was written."""
    assert outcome.said == {"ended": "target", "position_steps": [117, 105, 62]}
    expected = simulated_writes(wiring, "everything")
    assert outcome.writes()[-len(expected) :] == expected


def contact(wiring: str, outcome: Outcome) -> None:
    """A contact on the status line stops the motors within the tick in hand."""
    assert outcome.said["ended"] == "switch"
    accesses = outcome.accesses
    seen = next(
        i
        for i, a in enumerate(accesses)
        if not a.is_write and a.register == 1 and a.value == CONTACT
    )
    before, after = (Outcome({}, part).writes() for part in (accesses[:seen], accesses[seen:]))
    check_contact(wiring, before, after, outcome.said["position_steps"])


def motors_off(outcome: Outcome) -> None:
    """A signal while it moves: the last bytes switch the motors off, and are latched."""
    assert outcome.said["code"] == 0
    assert outcome.said["moving"] not in MOTORS_OFF
    _ends_with_motors_off(outcome.writes())
    assert outcome.said["left_on_pins"] == MOTORS_OFF[-1]


def _ends_with_motors_off(writes: Writes) -> None:
    assert steps_made("smc", writes) > 0
    check_motors_off(writes)


def killed(outcome: Outcome) -> None:
    """kill -9: nobody writes anything, the current stays on until another process takes over."""
    assert outcome.said["code"] == -9
    assert outcome.said["left_on_pins"] not in MOTORS_OFF
    assert outcome.said["pins_then"] == MOTORS_OFF[-1]
    _ends_with_motors_off(outcome.writes())


def driver_job(wiring: str, kind: str, outcome: Outcome) -> None:
    """The step process writes the same bytes, and a second program in between none."""
    said = outcome.said
    assert "is held by another program" in said["refused"]
    assert f", pid {said['step_process']})" in said["refused"]
    assert said["is_gone"]
    done = {name: said[name] for name in ("ended", "position_steps")}
    job(wiring, kind, Outcome(done, outcome.accesses))


def host_killed(outcome: Outcome) -> None:
    """The step process ends the tick in hand, switches the motors off, and is the last to write."""
    assert outcome.said["code"] == -9
    assert outcome.said["moving"] not in MOTORS_OFF
    assert outcome.said["left_on_pins"] == MOTORS_OFF[-1]
    _ends_with_motors_off(outcome.writes())


def step_process_killed(outcome: Outcome) -> None:
    """The program takes the port again, switches the motors off, and says so."""
    said = outcome.said["told"]
    assert said.startswith("The step process died (SIGKILL); the motors were switched off ")
    assert outcome.said["moving"] not in MOTORS_OFF
    assert outcome.said["left_on_pins"] == MOTORS_OFF[-1]
    _ends_with_motors_off(outcome.writes())


def second_program(kind: str, outcome: Outcome) -> None:
    """The second is refused with a sentence that names the first, which notices nothing."""
    said = outcome.said
    assert "is held by another program" in said["refused"]
    assert said["afterwards"] == ""
    assert outcome.data()[-2:] == [0x11, 0x12]
    if kind == "ppdev":
        assert f", pid {said['first_pid']})" in said["refused"]
        assert said["facts"]["registered"] == ["ppdev0"]
        assert said["facts"]["base"] == 0x378
    _nothing_between(outcome, 0x11, 0x12)


def _nothing_between(outcome: Outcome, first: int, second: int) -> None:
    """Between two bytes of the owner nobody else has written anything."""
    writes = outcome.writes()
    place = writes.index((DATA, first))
    assert writes[place + 1] == (DATA, second)


def careless_claimant(outcome: Outcome) -> None:
    """Also one that would share the port is refused at once."""
    assert outcome.said["refused"] == "ENXIO"
    assert outcome.data() == [0x21, 0x22]
    _nothing_between(outcome, 0x21, 0x22)


def printer_driver(outcome: Outcome) -> None:
    """lp first: our sentence; unloaded: free; after us: it gets nothing."""
    said = outcome.said
    assert said["refused"] == (
        "/dev/parport0 is held by the printer driver lp: unload it with sudo rmmod lp."
    )
    assert said["facts"]["registered"] == ["lp"]
    assert "lp" in said["facts"]["modules"]
    assert said["afterwards"] == ""
    assert said["late"]["registered"] == ["ppdev0"]
    _nothing_between(outcome, 0x31, 0x32)


def no_driver(outcome: Outcome) -> None:
    """Without ppdev there is no device; the sentence says how to load it."""
    assert "does not exist" in outcome.said["refused"]
    assert "sudo modprobe -a parport_pc ppdev" in outcome.said["refused"]
    assert outcome.said["facts"]["device"]["present"] is False
    assert outcome.said["afterwards"] == ""


def drivers_anew(outcome: Outcome) -> None:
    """Loading parport_pc makes the data lines dance, and leaves the control lines at rest."""
    assert outcome.said["refused"] == ""
    assert len(outcome.data()) >= 20
    controls = [write for write in outcome.writes() if write[0] == CONTROL]
    assert controls[-1] == AT_REST
    # No strobe: a phase-current card takes none of these bytes.
    assert not any(value & 1 for _, value in controls)


def permissions(outcome: Outcome) -> None:
    """Each refusal says what would help, and it does help."""
    said = outcome.said
    assert 'GROUP="lp"' in said["roots"]
    assert "join its group with sudo usermod -aG lp $USER" in said["groups"]
    assert said["member"] == ""
    assert "is for root with the right CAP_SYS_RAWIO only" in said["devport"]
    assert "is for root with the right CAP_SYS_RAWIO only" in said["no right"]


def looked_over(outcome: Outcome) -> None:
    """What the doctor finds there is so, and the motors are off when it has been there."""
    found = outcome.said
    assert [name for name, (state, *_) in found.items() if state == "bad"] == []
    assert "is there (" in found["device"][1]
    assert "given back, with motors and outputs off" in found["claim"][1]
    assert "no end switch is pressed" in found["inputs"][1]
    assert "Left with motors off" in found["outputs"][1]
    assert found["hypervisor"]
    check_motors_off(outcome.writes())


def lockdown(outcome: Outcome) -> None:
    """/dev/port is refused, and the sentence says why and what to take instead."""
    assert outcome.said["facts"]["lockdown"] == "integrity"
    assert re.match(
        r"/dev/port is refused by the kernel's lockdown \(integrity\).*ppdev",
        (outcome.said["devport"]),
    )


CHECKS: Final[Mapping[str, Callable[[Outcome], None]]] = {
    **{
        f"job, {wiring} on {kind}": partial(job, wiring, kind)
        for wiring in ("smc", "x4step")
        for kind in ("ppdev", "devport")
    },
    **{
        f"contact, {wiring} on {kind}": partial(contact, wiring)
        for wiring in ("smc", "x4step")
        for kind in ("ppdev", "devport")
    },
    "driver's contact, smc on ppdev": partial(contact, "smc"),
    "driver's job, smc on ppdev": partial(driver_job, "smc", "ppdev"),
    "kill -9 of the program, ppdev": host_killed,
    "kill -9 of the step process, devport": step_process_killed,
    "SIGTERM on ppdev": motors_off,
    "SIGTERM on devport": motors_off,
    "kill -9 on ppdev": killed,
    "second program on ppdev": partial(second_program, "ppdev"),
    "second program on devport": partial(second_program, "devport"),
    "careless claimant": careless_claimant,
    "printer driver": printer_driver,
    "no driver": no_driver,
    "drivers loaded anew": drivers_anew,
    "permissions": permissions,
    **{f"looked over, {kind}": looked_over for kind in ("ppdev", "devport")},
    "lockdown": lockdown,
    "locked job, smc on ppdev": partial(job_without_marks, "smc"),
}


def check(name: str, outcome: Outcome) -> None:
    """Judge a scenario.

    Raises:
        AssertionError: if what must be true of it is not, or it did not come to its end.
    """
    assert "failed" not in outcome.said, outcome.said["failed"]
    CHECKS[name](outcome)
