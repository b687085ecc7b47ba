"""Lines that disappear in the middle of a job and come back: parallel port, and USB as a terminal.

What is claimed afterwards has the carriages within it, the next command drives again and says where
it is, and motors are off in the end.
"""

import errno
import json
import subprocess
import time
from collections.abc import Sequence
from typing import Final

from bench.campaign.claims import Claim, claim_of, claimed
from bench.campaign.frame import Attempt, Kind, Late, Outcome
from bench.campaign.signals import begin, fake_port_missing
from bench.campaign.warm import Warm
from tests.bridge.device import reason_to_skip
from tests.bridge.stack import PATIENCE_S, Stack, until_moving
from tests.rigs.lpt.shop import Answer
from tests.rigs.lpt.steps import check_motors_off

_WITHIN_S: Final = 0.8
_AWAY_S: Final = 1.5
#: Who has noticed nothing until then was not hit.
_GOES_ON_S: Final = 8.0
_LONG: Final = "G21 G91\n" + "G1 X3 Y2 F400\nG1 X-3 Y-2\n" * 60


def port(attempt: Attempt) -> Outcome:
    """The parallel port refuses every access, for some time."""
    shop, chance = begin(attempt), attempt.random
    with shop.begun("run", "long.ngc", "--json") as command:
        time.sleep(chance.uniform(0, _WITHIN_S))
        at_s = time.monotonic()
        shop.fake.refuse("access", errno.EIO)
        time.sleep(chance.choice((0.0, 0.005, chance.uniform(0, _AWAY_S))))
        shop.fake.refuse("access", 0)
        took_s = _until_ended(command, at_s)
        if took_s is None:
            # Nothing was asked of it in that time.
            command.terminate()
        answer = shop.end(command)
    assert answer.code == (130 if took_s is None else 1), f"{answer.code}: {answer.noted}"
    claim, truth_steps = claimed(shop), shop.travelled_steps()
    beyond = claim.beyond_steps(truth_steps)
    again = shop.command("move", "X0.1", "--relative", "--json")
    assert again.code == 0, again.noted
    check_motors_off(shop.fake.writes())
    beyond += claim_of(again).beyond_steps(shop.travelled_steps())
    note = f"claimed {claim}, true {truth_steps}; then {again.result}, {shop.travelled_steps()}"
    return Outcome(beyond, took_s, note, missed=took_s is None and not beyond)


def _until_ended(command: "subprocess.Popen[str]", since_s: float) -> float | None:
    """How long the command lived; None: it goes on."""
    while command.poll() is None:
        if time.monotonic() > since_s + _GOES_ON_S:
            return None
        time.sleep(0.005)
    return time.monotonic() - since_s


def usb(attempt: Attempt) -> Outcome:
    """The bridge's serial port is gone, with its name; the board has current and goes on."""
    stack, chance = Stack(attempt.folder, popen=Warm), attempt.random
    with stack.mill:
        (attempt.folder / "long.ngc").write_text(_LONG)
        before = stack.mill.carriages_steps()
        command = stack.start("run", str(attempt.folder / "long.ngc"), "--json")
        try:
            until_moving(stack, 5)
            time.sleep(chance.uniform(0, _WITHIN_S))
            at_s = time.monotonic()
            stack.mill.host.unplug()
            said, noted = command.communicate(timeout=PATIENCE_S)
        finally:
            command.kill()
        took_s = time.monotonic() - at_s
        assert command.returncode == 1, f"exit code {command.returncode}: {noted}"
        # By itself it has braked and switched off, unless the simulated chip was given no time.
        time.sleep(0.5 + chance.uniform(0.5, 1.0))
        if stack.mill.currents() != {(0.0, 0.0)}:
            raise Late("the motors have current")
        stack.mill.host.plug_in()
        told = json.loads(said)["alarm"]["parameters"]
        claim = Claim(tuple(told["low_steps"]), tuple(told["high_steps"]))
        beyond = claim.beyond_steps(_made(stack, before))
        again = stack.run("move", "X0", "--relative", "--json")
        assert again.returncode == 0, again.stderr
        then = claim_of(Answer(0, again.stdout, again.stderr))
        beyond += then.beyond_steps(_made(stack, before))
        note = f"claimed {claim}, then {then}, true {_made(stack, before)}"
        return Outcome(beyond, took_s, f"{note}; {json.loads(said)['message']}")


def _made(stack: Stack, before: Sequence[float]) -> tuple[int, ...]:
    now = stack.mill.carriages_steps()
    return tuple(round(b - a) for a, b in zip(before, now, strict=True))


_MEASURES: Final = "s until the command has ended"
KINDS: Final = (
    Kind("parallel port gone and back", _MEASURES, port, missing=fake_port_missing),
    Kind("USB line of the bridge gone and back", _MEASURES, usb, many=100, missing=reason_to_skip),
)
