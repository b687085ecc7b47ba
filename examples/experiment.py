"""A learner's experiment: another phase table, and what the rotors make of it.

Run it with ``.venv/bin/python examples/experiment.py``.
"""

from fraese.assembly import assemble
from fraese.config import CardConfig, Config
from fraese.motor.phases import PHASE_TABLES

for name, table in PHASE_TABLES.items():
    if len(table) != 8:
        continue  # full steps: another number of steps per turn
    config = Config(card=CardConfig(table=name))
    plant = assemble(config)
    plant.controller.jog("x", 5)
    plant.controller.run()
    seen = plant.port.look()
    print(f"{name:10} carriage {seen.carriages_steps[0]:8.1f}  lost {seen.lost_steps[0]:g}")
    plant.close()
