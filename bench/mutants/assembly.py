"""What a machine is put together from, and what outlives a program."""

from typing import Final

from bench.mutants.mutant import Mutant

_A: Final = "fraese/assembly/"
_LASER: Final = ("tests/program/test_laser.py",)

MUTANTS: Final = (
    Mutant(
        "assembly/drivers: no output is safe at standstill",
        "the laser burns on while a program is held",
        _A + "drivers.py",
        'return self.config.outputs.mask("laser")',
        "return 0",
        _LASER,
    ),
    Mutant(
        "assembly/drivers: the step process is not told of the laser",
        "the laser burns on while a program is held",
        _A + "drivers.py",
        "        safe_outputs=order.safe_outputs,\n        options=",
        "        options=",
        _LASER,
    ),
    Mutant(
        "assembly/drivers: the bridge is not told of the laser",
        "the laser burns on while a program is held",
        _A + "drivers.py",
        "            safe_outputs=safe_outputs,\n            silence_s=",
        "            silence_s=",
        _LASER,
    ),
)
