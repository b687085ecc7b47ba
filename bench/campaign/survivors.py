"""Hosts that are killed, and the bridge that lives on: what the next one claims, against the mill.

    host --killed--> firmware brakes by itself --asked--> place, to the step

The firmware is the real one in the simulated microcontroller; truth are the carriages on its pins.
A place that is not known to the step counts as unaccounted for.
"""

import os
import time
from collections.abc import Sequence
from typing import Final

from bench.campaign.claims import claim_of
from bench.campaign.frame import Attempt, Kind, Late, Outcome
from bench.campaign.warm import Warm
from fraese.assembly.survivors import KNOWN
from fraese.motor.bridge.survivor import ask
from tests.bridge.device import reason_to_skip
from tests.bridge.dying import killed_on_errands, left
from tests.bridge.firmwaremill import FirmwareBench
from tests.bridge.stack import PATIENCE_S, Stack, until_moving
from tests.rigs.lpt.shop import Answer
from tests.rigs.lpt.terminal import Terminal

#: The next host comes so long after: before the bridge has noticed, while it brakes, or later.
_NEXT_S: Final = (0.0, 0.1, 0.5, 0.6, 1.0)
#: A command is killed within this time after it has begun to move.
_WITHIN_S: Final = 1.5
#: A jog in the app is over sooner.
_JOG_WITHIN_S: Final = 0.3
_LONG: Final = "G21 G90\n" + "".join(
    f"G1 X{n % 5} Y{n % 3} Z-{n % 2} F{300 + n % 7 * 50}\n" for n in range(400)
)


def host_killed(attempt: Attempt) -> Outcome:
    """SIGKILL at any cycle, even within a write; the chip's time."""
    chance, ledger = attempt.random, attempt.folder / "ledger"
    bench = FirmwareBench(chance.choice(("smc", "x4step")), silence_s=0.5)
    before = bench.carriages()
    killed_on_errands(bench, ledger, chance)
    bench.wait(chance.choice(_NEXT_S))
    since_ns = bench.clock.now_ns()
    words = ask(bench.open_line, bench.clock, left(ledger))
    took_ms = (bench.clock.now_ns() - since_ns) * 1e-6
    if words is None:
        return Outcome(1, took_ms, "nothing is known")
    made = [b - a for a, b in zip(before, bench.carriages(), strict=True)]
    off = round(sum(abs(a - b) for a, b in zip(words.position_steps, made, strict=True)))
    return Outcome(off, took_ms, f"{words.position_steps} claimed, true {made}")


def command_killed(attempt: Attempt) -> Outcome:
    """SIGKILL to a command in a program; the next command says where it is."""
    stack = Stack(attempt.folder, popen=Warm)
    with stack.mill:
        (attempt.folder / "long.ngc").write_text(_LONG)
        before = stack.mill.carriages_steps()
        command = stack.start("run", str(attempt.folder / "long.ngc"))
        try:
            until_moving(stack, 5)
            time.sleep(attempt.random.uniform(0, _WITHIN_S))
        finally:
            command.kill()
            command.communicate(timeout=PATIENCE_S)
        return _asked(stack, before, attempt)


def app_killed(attempt: Attempt) -> Outcome:
    """SIGKILL to the app in a jog; the next command says where it is."""
    stack = Stack(attempt.folder, popen=Warm)
    with stack.mill:
        before = stack.mill.carriages_steps()
        app = Terminal(
            stack.words(), attempt.folder, {**os.environ, "TERM": "xterm-256color"}, Warm
        )
        try:
            app.wait_for("Hold")
            app.press("4", "right", "right", "right")
            until_moving(stack, 5)
            time.sleep(attempt.random.uniform(0, _JOG_WITHIN_S))
            app.process.kill()
            app.wait_for_end()
        finally:
            app.close()
        return _asked(stack, before, attempt)


def _asked(stack: Stack, before: Sequence[float], attempt: Attempt) -> Outcome:
    """What the next command says, against what the carriages did."""
    time.sleep(attempt.random.choice(_NEXT_S))
    since_s = time.monotonic()
    answer = stack.run("move", "X0", "--relative", "--json")
    took_s = time.monotonic() - since_s
    assert answer.returncode == 0, answer.stderr + answer.stdout
    made = [b - a for a, b in zip(before, stack.mill.carriages_steps(), strict=True)]
    claim = claim_of(Answer(0, answer.stdout, answer.stderr))
    true_steps = tuple(round(steps) for steps in made)
    known = KNOWN in answer.stderr
    note = f"claimed {claim} (asked: {known}), true {true_steps}; {answer.stderr}"
    off = claim.beyond_steps(true_steps)
    if not off and not known:
        # The bounds hold; the chip was given no time to say more.
        raise Late(note)
    return Outcome(off + (not known), took_s, note)


KINDS: Final = (
    Kind("SIGKILL to a host, its bridge is asked", "ms of the question", host_killed,
         missing=reason_to_skip),
    Kind("SIGKILL to a command, the next one asks its bridge", "s of the next command",
         command_killed, many=100, missing=reason_to_skip),
    Kind("SIGKILL to the app, the next command asks its bridge", "s of the next command",
         app_killed, many=100, missing=reason_to_skip),
)  # fmt: skip
