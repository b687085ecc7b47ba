"""Scenarios of the guest with the real-time driver: its jobs, and the deaths of its two processes.

host process  --blocks-->  step process  -->  /dev/parport0, /dev/port
     kill -9: the other switches the motors off
"""

import os
import signal
import time

from fraese.errors import PortError
from rigs.lpt import drive
from rigs.lpt.forked import Forked
from rigs.lpt.tools import Said, pins, refusal, wait_for, wait_until_it_moves
from tests.rigs.lpt.play import JOBS, play


def driver_job(wiring: str, kind: str) -> Said:
    """A job from claim to release; a second program asks for the port before it begins."""
    driver = drive.driver_on(wiring, kind)
    pid, refused = driver.pid, refusal(kind)
    report = play(driver, "everything")
    return {
        "ended": report.ended.value,
        "position_steps": report.position_steps,
        "step_process": pid,
        "refused": refused,
        "is_gone": _is_gone(pid),
    }


def host_killed(kind: str) -> Said:
    """kill -9 of the program while it moves; its step process is nobody's child then."""
    host = Forked("rigs.lpt.drive", "smc", kind, "endless")
    moving = wait_until_it_moves()
    killed_s = time.monotonic()
    host.kill()
    said, _ = host.communicate()
    step_process = int(said)
    wait_for(lambda: _is_gone(step_process))
    return {
        "moving": moving,
        "code": host.returncode,
        "took_s": round(time.monotonic() - killed_s, 3),
        "left_on_pins": pins(),
    }


def step_process_killed(kind: str) -> Said:
    """kill -9 of the step process while it moves; the program is told."""
    driver = drive.driver_on("smc", kind)
    for block in JOBS["endless"]():
        driver.push(block)
    driver.poll(0.1)
    moving = wait_until_it_moves()
    os.kill(driver.pid, signal.SIGKILL)
    told = ""
    while not told:
        try:
            driver.poll(0.05)
        except PortError as error:
            told = str(error)
    left_on_pins = pins()
    driver.close()
    return {"moving": moving, "told": told, "left_on_pins": left_on_pins}


def _is_gone(pid: int) -> bool:
    """It has ended; one whom nobody asked for his end is a zombie."""
    try:
        with open(f"/proc/{pid}/stat") as file:
            return file.read().rpartition(")")[2].split()[0] == "Z"
    except (FileNotFoundError, ProcessLookupError):
        return True
