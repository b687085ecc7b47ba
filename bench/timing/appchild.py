"""The app with a step process that is measured: ``python -m bench.timing.appchild SECONDS FOLDER``.

Runs in a pseudo-terminal. The row of the table of drivers that is asked for is ours: the real-time
driver as the app makes it, on a port that leads nowhere, with a meter. As soon as the motors run,
it measures for so many seconds, writes the lateness to ``FOLDER/samples``, and goes on.
"""

import sys
import threading
import time
from pathlib import Path
from unittest.mock import patch

from fraese.assembly import drivers
from fraese.assembly import plant as plant_module
from fraese.assembly.drivers import Made, Order, realtime_options
from fraese.config.file import from_table
from fraese.motor.clock import MonotonicClock
from fraese.motor.ports.null import NullPort
from fraese.motor.realtime.driver import RealtimeDriver
from fraese.motor.realtime.setup import Meter, Setup
from fraese.motor.seams import CONTROL
from fraese.program.program import open_program
from fraese.ui import FraeseApp

RATE_HZ = 5000
_STROBE = 0x01
_LOOK_S = 0.05
_TRAVEL_MM = 30_000
#: All axes at their highest rate for a quarter of an hour, without a ramp: what is measured without
#: the app has none either.
PROGRAM = f"G90\nG0 X{_TRAVEL_MM * 0.8:g} Y{_TRAVEL_MM * 0.8:g} Z{_TRAVEL_MM * 0.8:g}\nM2\n"
_AXIS = {
    "start_rate_hz": RATE_HZ,
    "max_rate_hz": RATE_HZ,
    "acceleration_hz_s": 40_000,
    "travel_mm": _TRAVEL_MM,
}
CONFIG = {
    "port": {"kind": "ppdev"},
    "axes": dict.fromkeys("xyz", _AXIS),
    "run": {"unreferenced_percent": 100},
}


def _measured(order: Order) -> Made:
    room = RATE_HZ * 600
    setup = Setup(
        NullPort,
        order.card,
        switch=order.switch,
        settle_s=order.settle_s,
        options=realtime_options(order.config),
        meter=Meter(CONTROL, _STROBE, room),
    )
    driver = RealtimeDriver(setup)
    threading.Thread(target=_write_samples, args=(driver,), daemon=True).start()
    return Made(driver, MonotonicClock(), 0.02)


def _write_samples(driver: RealtimeDriver) -> None:
    seconds, folder = float(sys.argv[1]), Path(sys.argv[2])
    while not driver.samples()[0]:
        time.sleep(_LOOK_S)
    time.sleep(seconds)
    late_ns, span_s = driver.samples()
    fresh = folder / "fresh"
    fresh.write_bytes(f"{span_s}\n".encode() + late_ns)
    fresh.rename(folder / "samples")


def main(folder: Path) -> None:
    """The app, with the program open."""
    path = folder / "part.ngc"
    path.write_text(PROGRAM)
    with patch.object(drivers, "DRIVERS", {"ppdev": _measured}):
        plant = plant_module.assemble(from_table(CONFIG, "bench"), clock="paced")
    FraeseApp(plant.controller, open_program=open_program, program=path).run()


if __name__ == "__main__":
    main(Path(sys.argv[2]))
