"""`simcore.h` for Python: its types, its numbers and the signatures of its functions."""

import ctypes
from dataclasses import dataclass
from enum import IntFlag
from typing import Any

import numpy as np
import numpy.typing as npt

from rigs.avr.build import core_library

#: One entry of the log, or one byte sent. Kinds are the letters of `simcore.h`: B C D a port was
#: written, b c d its direction register was, R a reset, T a byte sent.
EVENT = np.dtype([("cycle", "<u8"), ("kind", "u1"), ("value", "u1"), ("unused", "V6")])
Events = npt.NDArray[np.void]
SRAM_START = 0x100
SRAM_END = 0x900
VECTORS = 32


class Repair(IntFlag):
    """What the harness corrects in simavr 1.6. The values are those of `enum sim_repair`."""

    ENTRY = 1 << 0
    SHADOW = 1 << 1
    UART = 1 << 2
    EQUAL_WRITES = 1 << 3
    LATE_ENABLE = 1 << 4
    CTC_ZERO = 1 << 5
    STOPPED_COUNT = 1 << 6
    LEVEL_POLL = 1 << 7
    DRIVEN_PINS = 1 << 8
    FLAG_WRITES = 1 << 9
    SLEEP = 1 << 10
    WRITE_END = 1 << 11
    EARLY_MATCH = 1 << 12
    ALL = (1 << 13) - 1


@dataclass(frozen=True, slots=True)
class Counters:
    """What the harness counted since power-on; see `sim_counters_t`."""

    rx_bytes: int
    tx_bytes: int
    overruns: int
    unheard: int
    framing_errors: int
    tx_dropped: int
    resets: int
    slept_cycles: int
    batches: int


@dataclass(frozen=True, slots=True)
class VectorUse:
    """How often an interrupt ran, and how long, entry (4 cycles) and RETI included."""

    count: int
    total_cycles: int
    max_cycles: int


class RawCounters(ctypes.Structure):
    """`sim_counters_t`."""

    _fields_ = [(name, ctypes.c_uint64) for name in Counters.__dataclass_fields__]


class RawVector(ctypes.Structure):
    """`sim_vector_t`."""

    _fields_ = [(name, ctypes.c_uint64) for name in VectorUse.__dataclass_fields__]


#: `sim_watcher_t`.
RAW_WATCHER = ctypes.CFUNCTYPE(
    None, ctypes.c_void_p, ctypes.c_uint64, ctypes.c_uint8, ctypes.c_uint8
)

_SIM, _U64, _INT, _CHAR = ctypes.c_void_p, ctypes.c_uint64, ctypes.c_int, ctypes.c_char
_U8, _U32, _SIZE, _DOUBLE = ctypes.c_uint8, ctypes.c_uint32, ctypes.c_size_t, ctypes.c_double
_BUFFER = ctypes.c_char_p

#: Function of `simcore.h`: result, arguments.
_PROTOTYPES: dict[str, tuple[Any, tuple[Any, ...]]] = {
    "sim_open": (_SIM, (_BUFFER, _U32)),
    "sim_close": (None, (_SIM,)),
    "sim_reset": (None, (_SIM,)),
    "sim_run": (_INT, (_SIM, _U64)),
    "sim_stop": (None, (_SIM,)),
    "sim_cycle": (_U64, (_SIM,)),
    "sim_log": (_SIZE, (_SIM, ctypes.POINTER(ctypes.c_void_p))),
    "sim_clear_log": (None, (_SIM,)),
    "sim_counters": (ctypes.POINTER(RawCounters), (_SIM,)),
    "sim_vectors": (ctypes.POINTER(RawVector), (_SIM,)),
    "sim_data": (ctypes.c_void_p, (_SIM,)),
    "sim_data_end": (ctypes.c_uint16, (_SIM,)),
    "sim_stack_low": (ctypes.c_uint16, (_SIM,)),
    "sim_pc": (_U32, (_SIM,)),
    "sim_feed": (None, (_SIM, _BUFFER, _SIZE, _U64, _U32)),
    "sim_backlog": (_SIZE, (_SIM,)),
    "sim_drop_backlog": (None, (_SIM,)),
    "sim_take": (_SIZE, (_SIM, ctypes.c_void_p, _SIZE)),
    "sim_host_bit_cycles": (None, (_SIM, _DOUBLE)),
    "sim_bit_cycles": (_DOUBLE, (_SIM,)),
    "sim_set_pin": (None, (_SIM, _CHAR, _INT, _INT)),
    "sim_schedule_pin": (None, (_SIM, _U64, _CHAR, _INT, _INT)),
    "sim_contact": (_INT, (_SIM, _CHAR, _U8, _U8, _U64, _U64, _CHAR, _INT, _INT)),
    "sim_watch": (_INT, (_SIM, _CHAR, _U8, _U8, RAW_WATCHER, ctypes.c_void_p)),
    "sim_watch_count": (_U64, (_SIM, _INT)),
    "sim_unwatch": (None, (_SIM, _INT)),
}


def load() -> ctypes.CDLL:
    """The harness, with the types of its functions set.

    Raises:
        RigError: It cannot be built.
    """
    library = ctypes.CDLL(str(core_library()))
    for name, (result, arguments) in _PROTOTYPES.items():
        function = getattr(library, name)
        function.restype = result
        function.argtypes = arguments
    return library
