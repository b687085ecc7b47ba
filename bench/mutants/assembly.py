"""What a machine is put together from, and what outlives a program."""

from typing import Final

from bench.mutants.mutant import Mutant, tests_of

_A: Final = "fraese/assembly/"
_LASER: Final = ("tests/program/test_laser.py",)

MUTANTS: Final = (
    Mutant(
        "assembly/drivers: no output is safe at standstill",
        "the laser burns on while a program is held",
        _A + "drivers.py",
        "return self.config.outputs.off_at_rest",
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
    Mutant(
        "assembly/survivors: words of any session are believed",
        "a place of another day is trusted",
        _A + "survivors.py",
        "words is not None and words.token == opening.token",
        "words is not None",
        tests_of("assembly/test_survivors.py", "test_else_the_bounds_of_the_record_hold"),
    ),
    Mutant(
        "assembly/keeping: words are not taken over",
        "a second crash before anything moves loses the place",
        _A + "keeping.py",
        "                self.write(kept, durable=True)\n",
        "                pass\n",
        tests_of(
            "assembly/test_survivors.py",
            "test_who_drives_takes_it_over_before_the_words_are_overwritten",
        ),
    ),
)
