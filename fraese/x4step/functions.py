"""The sixteen functions of the manual, under their own names, on one port at a time.

They answer with codes, as in C, and raise nothing for what the manual has a code for; what is no
integer is a TypeError, and changes nothing. A port that cannot be opened, or was lost, is 6; why is
written to standard error and to the log.
"""

import time
from collections.abc import Callable, Iterable
from operator import index

from fraese.errors import ConfigError, PortError, TraceError
from fraese.x4step import surroundings, verdicts
from fraese.x4step.codes import (
    PORTS,
    X4ErrInitNotDone,
    X4ErrLPTNotFound,
    X4Error,
    X4ErrParamFail,
    X4Failure,
    X4NoErr,
)
from fraese.x4step.complaints import complain
from fraese.x4step.machine import X4Step
from fraese.x4step.verdicts import Asked, Rows

_machine: X4Step | None = None
#: The second half of a key that ``getch`` tells in two.
_rest_of_key: list[str] = []


def X4Init(lpt: int) -> X4Error:
    """Take a port, 1 to 4; all other functions need it. Done twice, it begins anew."""
    global _machine

    def take() -> None:
        global _machine
        if _machine is not None:
            _machine.require_standstill()
        if index(lpt) not in PORTS:
            raise X4Failure(X4ErrParamFail)
        X4ReInit()
        _machine = X4Step(lpt)

    return _answer(take)


def X4ReInit() -> X4Error:
    """Brake and wait if axes move, then switch all off and give the port back."""
    global _machine
    machine, _machine = _machine, None
    if machine is None or not machine.is_open:
        return X4ErrInitNotDone
    return _answer(machine.close)


def X4Load(weg1: int, weg2: int, weg3: int, weg4: int, freq: int, ramp: int) -> X4Error:
    """Load a path: signed steps of the four axes, rate in Hz and ramp in ms of the longest."""
    return _do(verdicts.LOAD, lambda x4: x4.load((weg1, weg2, weg3, weg4), freq, ramp))


def X4Start() -> X4Error:
    """Start what was loaded."""
    return _do(verdicts.START, lambda x4: x4.start())


def X4MovePos(achse: int, freq: int, ramp: int) -> X4Error:
    """Move one axis in positive direction until it is braked or stopped."""
    return _do(verdicts.MOVE, lambda x4: x4.move_positive(achse, freq, ramp))


def X4MoveNeg(achse: int, freq: int, ramp: int) -> X4Error:
    """Move one axis in negative direction until it is braked or stopped."""
    return _do(verdicts.MOVE, lambda x4: x4.move_negative(achse, freq, ramp))


def X4Brake() -> X4Error:
    """Brake along the ramp of the present path."""
    return _do(verdicts.BRAKE, lambda x4: x4.brake())


def X4Stop() -> X4Error:
    """Stop at once, without a ramp."""
    return _do(verdicts.BRAKE, lambda x4: x4.stop())


def X4GetState() -> int:
    """0: all axes stand; above 0: one or more move."""
    return _asked(lambda x4: int(x4.moving))


def X4GetSteps(achse: int) -> int:
    """Signed steps of an axis since the last start."""
    return _asked(lambda x4: x4.steps(achse))


def X4BrakeCodes(codes: Iterable[int] | str) -> X4Error:
    """Scan codes of up to 20 keys that brake, besides ESC; a 0 ends them."""
    return _do(verdicts.BRAKE_CODES, lambda x4: x4.brake_codes(codes))


def X4LastBrakeCode() -> int:
    """Scan code that ended the last motion; 0 if no key did."""
    return _asked(lambda x4: x4.last_brake_code)


def X4ClearTimer() -> None:
    """Count milliseconds from 0 again."""
    if _machine is not None:
        _machine.clear_timer()


def X4GetTimer() -> int:
    """Milliseconds since X4Init or X4ClearTimer."""
    return _asked(lambda x4: x4.timer_ms)


def X4GetIn() -> int:
    """Levels of the inputs: bits 4 to 0 are pins 11, 10, 12, 13 and 15, 1 is high."""
    return _asked(lambda x4: x4.inputs)


def X4SetOut(sig: int) -> X4Error:
    """Switch signal 1 on (1) or off (2), signal 2 on (3) or off (4)."""
    return _do(verdicts.SET_OUT, lambda x4: x4.set_output(sig))


def getch() -> str:
    """The next key, as conio.h has it: a character; NUL and then the make code for arrows and such.

    Waits for one; while axes move the keyboard is X4Step's, so first for their standstill. Keys
    that were typed before a motion come from here, not from ``input``.

    Raises:
        EOFError: if there will be none.
    """
    if _rest_of_key:
        return _rest_of_key.pop()
    if _machine is not None:
        _machine.wait()
    text = surroundings.present().keyboard.getch().text
    _rest_of_key.extend(text[1:])
    return text[0]


def kbhit() -> bool:
    """A key waits for ``getch``; none does while axes move."""
    if _rest_of_key:
        return True
    moving = _machine is not None and _machine.moving
    return not moving and surroundings.present().keyboard.kbhit()


def last_scan_code() -> int:
    """The last make or break code that was heard: what port 60h of a PC reads."""
    return surroundings.present().keyboard.last_code


def pass_ms(ms: int) -> None:
    """Let time pass, as dos.h's delay does; on a virtual clock no real time."""
    if _machine is None:
        time.sleep(ms / 1000)
    else:
        _machine.pass_time(ms / 1000)


def machine() -> X4Step | None:
    """What X4Init made; None before it and after X4ReInit."""
    return _machine


def _do(rows: Rows, action: Callable[[X4Step], None]) -> X4Error:
    x4 = _machine
    if x4 is None or not x4.is_open:
        return verdicts.verdict(rows, Asked())
    return _answer(lambda: action(x4))


def _asked(question: Callable[[X4Step], int]) -> int:
    return 0 if _machine is None else question(_machine)


def _answer(action: Callable[[], object]) -> X4Error:
    try:
        action()
    except X4Failure as failure:
        return failure.code
    except (PortError, ConfigError, TraceError) as error:
        complain(str(error))
        return X4ErrLPTNotFound
    return X4NoErr
