"""All rows."""

from typing import Final

from bench.mutants import (
    app,
    assembly,
    bridge,
    control,
    crashes,
    firmware,
    motor,
    planner,
    program,
    realtime,
    serve,
)
from bench.mutants.mutant import Mutant

MUTANTS: Final[tuple[Mutant, ...]] = (
    *motor.MUTANTS,
    *realtime.MUTANTS,
    *bridge.MUTANTS,
    *firmware.MUTANTS,
    *planner.MUTANTS,
    *control.MUTANTS,
    *program.MUTANTS,
    *assembly.MUTANTS,
    *app.MUTANTS,
    *crashes.MUTANTS,
    *serve.MUTANTS,
)
