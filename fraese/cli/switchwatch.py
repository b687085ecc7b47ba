"""The end switches, pressed by hand and seen; nothing moves."""

import json
import sys
import time
from typing import Final

from fraese.cli.output import say, tell
from fraese.control.controller import Controller
from fraese.control.switchtest import SwitchTest
from fraese.phrases import joined, phrase

_LOOK_EVERY_S: Final = 0.05


def watch_switches(controller: Controller, *, as_json: bool) -> int:
    """Let each end switch be pressed by hand and say what is seen; the exit code.

    With ``--json``, or where nobody sits at a terminal, one look is all.
    """
    if as_json or not sys.stdout.isatty():
        return _look_once(controller, as_json=as_json)
    axes = [axis.name for axis in controller.machine.axes if axis.has_switches]
    if not axes:
        say(phrase("This machine has no end switches."))
        return 0
    test = SwitchTest(axes)
    shown = ""
    while not test.done:
        since_s = time.monotonic()
        time.sleep(_LOOK_EVERY_S)
        controller.idle(time.monotonic() - since_s)
        seen = test.look(controller.state().switch_closed)
        if seen:
            tell(phrase("{seen} seen", seen=seen), over=True)
        if test.sentence() != shown:
            shown = test.sentence()
            tell(shown + " ", end="", over=True)
    tell(test.sentence(), over=True)
    return 0


def _look_once(controller: Controller, *, as_json: bool) -> int:
    for _ in range(controller.config.switches.readings):
        controller.idle()
    state = controller.state()
    if as_json:
        values = {
            "switch_closed": state.switch_closed,
            "ends": list(state.ends),
            "inputs": {str(pin): high for pin, high in state.inputs.items()},
        }
        say(json.dumps(values))
    else:
        words = {True: phrase("high"), False: phrase("low")}
        levels = [joined(":", (str(pin), words[high])) for pin, high in state.inputs.items()]
        pins = joined(" ", levels)
        say(
            phrase(
                "end switches {word}; pins {pins}",
                word=phrase("closed") if state.switch_closed else phrase("open"),
                pins=pins,
            )
        )
    return 0
