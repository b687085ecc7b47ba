"""A simulated ATmega328P as a Python object: run, feed, take, look at the pins.

    avr = Avr(firmware(Path("blink.c")))
    avr.run(16_000_000)                 # one second of 16 MHz
    avr.log()["cycle"]                  # when each port was written

Time is counted in cycles of 16 MHz since power-on, one cycle being 62.5 ns. Runs are deterministic,
and nothing waits for the wall clock. Any number of instances may live in one process.
"""

import ctypes
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np

from rigs.avr.binding import (
    EVENT,
    RAW_WATCHER,
    SRAM_END,
    VECTORS,
    Counters,
    Events,
    Repair,
    VectorUse,
    load,
)
from rigs.avr.build import RigError

__all__ = ["EVENT", "Avr", "Counters", "Events", "Repair", "RigError", "VectorUse", "Watcher"]

#: Called with the cycle, the port's letter and the value written.
Watcher = Callable[[int, str, int], None]

TAKE_ROOM = 512


class Avr:
    """One microcontroller with its firmware, just powered on.

    Args:
        elf: The image, as `avr-gcc` links it.
        repairs: What is corrected in simavr; less than everything is for the self-tests.

    Raises:
        RigError: The harness cannot be built, or the image cannot be read.
    """

    def __init__(self, elf: Path, repairs: Repair = Repair.ALL) -> None:
        self._lib = load()
        self._sim: int | None = self._lib.sim_open(str(elf).encode(), int(repairs))
        if not self._sim:
            raise RigError(f"{elf} is no image for the ATmega328P")
        self._watchers: dict[int, Any] = {}

    def close(self) -> None:
        """Frees it. Nothing else may be called afterwards."""
        if self._sim:
            self._lib.sim_close(self._sim)
            self._sim = None

    def __enter__(self) -> "Avr":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        self.close()

    # -- time

    @property
    def cycle(self) -> int:
        """Cycles since power-on."""
        return int(self._lib.sim_cycle(self._sim))

    def run(self, cycles: int) -> bool:
        """Runs for so many cycles, to the end of the instruction in which they are reached.

        Returns:
            False when the core has stopped: asleep with interrupts off, or crashed.
        """
        return bool(self._lib.sim_run(self._sim, cycles))

    def run_until(self, done: Callable[[], bool], limit_cycles: int, slice_cycles: int) -> bool:
        """Runs in slices until `done()`; False when the limit passed or the core stopped first."""
        end_cycle = self.cycle + limit_cycles
        while not done():
            if self.cycle >= end_cycle or not self.run(slice_cycles):
                return done()
        return True

    def stop(self) -> None:
        """Called by a watcher: ends the run after the instruction in hand."""
        self._lib.sim_stop(self._sim)

    def reset(self) -> None:
        """Pulls the reset pin: what opening the serial port does to an Arduino."""
        self._lib.sim_reset(self._sim)

    # -- what was seen

    def log(self) -> Events:
        """Everything since power-on or the last `take_log`, as an array of `EVENT`."""
        start = ctypes.c_void_p()
        count = self._lib.sim_log(self._sim, ctypes.byref(start))
        if not count or start.value is None:
            return np.zeros(0, EVENT)
        return np.frombuffer(ctypes.string_at(start.value, count * EVENT.itemsize), EVENT)

    def take_log(self) -> Events:
        """The log, which is empty afterwards: for runs too long to keep."""
        events = self.log()
        self._lib.sim_clear_log(self._sim)
        return events

    def writes(self, port: str) -> Events:
        """The log's writes of one port: "B", "C", "D", or "b", "c", "d" for its directions."""
        events = self.log()
        chosen: Events = events[events["kind"] == ord(port)]
        return chosen

    @property
    def counters(self) -> Counters:
        """Bytes, overruns, resets and so on, since power-on."""
        raw = self._lib.sim_counters(self._sim).contents
        return Counters(*(getattr(raw, name) for name in Counters.__dataclass_fields__))

    def vectors(self) -> dict[int, VectorUse]:
        """The interrupts that ran, by vector number (11 is timer 1 compare A)."""
        raw = self._lib.sim_vectors(self._sim)
        uses = (
            VectorUse(raw[i].count, raw[i].total_cycles, raw[i].max_cycles) for i in range(VECTORS)
        )
        return {number: use for number, use in enumerate(uses) if use.count}

    # -- memory

    def peek(self, address: int, count: int = 1) -> bytes:
        """Bytes of the data space: I/O registers from 0x20, SRAM from 0x100.

        Raises:
            RigError: The addresses are outside.
        """
        if not 0 <= address <= address + count <= SRAM_END:
            raise RigError(f"no data memory at {address:#x} to {address + count:#x}")
        return ctypes.string_at(self._lib.sim_data(self._sim) + address, count)

    @property
    def stack_free(self) -> int:
        """Bytes between the data and the deepest the stack has ever been; 0 means they met."""
        return int(self._lib.sim_stack_low(self._sim) - self._lib.sim_data_end(self._sim))

    @property
    def pc(self) -> int:
        """Byte address of the next instruction, as `avr-objdump` prints it."""
        return int(self._lib.sim_pc(self._sim))

    # -- the wire

    def feed(self, data: bytes, *, at_cycle: int = 0, gap_cycles: int = 0) -> None:
        """Puts bytes on the wire to the AVR, one after the other at the baud rate.

        Args:
            data: The bytes.
            at_cycle: The first start bit comes no earlier.
            gap_cycles: Idle line before each of them.
        """
        self._lib.sim_feed(self._sim, data, len(data), at_cycle, gap_cycles)

    @property
    def backlog(self) -> int:
        """Bytes fed that have not arrived yet."""
        return int(self._lib.sim_backlog(self._sim))

    def drop_backlog(self) -> None:
        """The host stops sending: what has not begun to arrive is forgotten."""
        self._lib.sim_drop_backlog(self._sim)

    def take(self) -> bytes:
        """The bytes sent by the AVR since the last call."""
        return self.take_timed()["value"].tobytes()

    def take_timed(self) -> Events:
        """The bytes sent, each with the cycle at which its stop bit ended."""
        parts = []
        while True:
            room = np.empty(TAKE_ROOM, EVENT)
            count = self._lib.sim_take(self._sim, room.ctypes.data, TAKE_ROOM)
            parts.append(room[:count])
            if count < TAKE_ROOM:
                return parts[0] if len(parts) == 1 else np.concatenate(parts)

    def set_host_baud(self, baud: float | None) -> None:
        """The host's baud rate, where it is not the firmware's; None: it follows the firmware."""
        self._lib.sim_host_bit_cycles(self._sim, 16e6 / baud if baud else 0.0)

    @property
    def bit_cycles(self) -> float:
        """Cycles per bit, as the firmware has set them."""
        return float(self._lib.sim_bit_cycles(self._sim))

    # -- the pins

    def set_pin(self, pin: str, level: bool) -> None:
        """Drives an input pin, from now on. Pins are named as on the data sheet: "C0"."""
        self._lib.sim_set_pin(self._sim, *_named(pin), int(level))

    def schedule(self, changes: Iterable[tuple[int, str, bool]]) -> None:
        """Drives input pins at given cycles.

        An instruction that begins at the cycle or later sees the new level.

        Args:
            changes: (cycle, pin, level), in any order.
        """
        for cycle, pin, level in changes:
            self._lib.sim_schedule_pin(self._sim, cycle, *_named(pin), int(level))

    def contact(
        self,
        port: str,
        mask: int,
        value: int,
        *,
        count: int,
        pin: str,
        level: bool,
        delay_cycles: int = 0,
    ) -> int:
        """A contact that closes by what the firmware does, not by the clock.

        Args:
            port: The port watched: "B", "C" or "D".
            mask: Which bits.
            value: It counts how often they become this.
            count: At which count the pin changes.
            pin: The pin driven.
            level: Its level then.
            delay_cycles: How long after the write.

        Returns:
            A number for `watched` and `unwatch`.

        Raises:
            RigError: 64 watches are in use.
        """
        return self._checked(
            self._lib.sim_contact(
                self._sim, port.encode(), mask, value, count, delay_cycles, *_named(pin), int(level)
            )
        )

    def watch(self, port: str, mask: int, value: int, watcher: Watcher) -> int:
        """Calls somebody in the middle of the run, each time (port & mask) becomes `value`.

        The watcher may call `set_pin`, `schedule`, `feed` and `stop`.

        Raises:
            RigError: 64 watches are in use.
        """

        def called(_: object, cycle: int, kind: int, written: int) -> None:
            watcher(cycle, chr(kind), written)

        callback = RAW_WATCHER(called)
        number = self._checked(
            self._lib.sim_watch(self._sim, port.encode(), mask, value, callback, None)
        )
        self._watchers[number] = callback  # C keeps the address; Python must keep the object
        return number

    def watched(self, number: int) -> int:
        """How often a watch has seen its value."""
        return int(self._lib.sim_watch_count(self._sim, number))

    def unwatch(self, number: int) -> None:
        """Ends a watch or a contact."""
        self._lib.sim_unwatch(self._sim, number)
        self._watchers.pop(number, None)

    def _checked(self, number: int) -> int:
        if number < 0:
            raise RigError("all 64 watches are in use; end one with unwatch()")
        return number


def _named(pin: str) -> tuple[bytes, int]:
    """Port and number of a pin like "C0", as the harness wants them."""
    if len(pin) != 2 or pin[0] not in "BCD" or pin[1] not in "01234567":
        raise RigError(f"no pin {pin!r}; B0 to D7 are pins")
    return pin[0].encode(), int(pin[1])
