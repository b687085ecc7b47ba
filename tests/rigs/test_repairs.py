"""What simavr 1.6 gets wrong and the harness repairs: each fact as the data sheet has it.

Every measurement is made twice: with all repairs it gives what the silicon gives, and without the
one repair it does not. So the rig is known to be able to fail.
"""

from collections.abc import Callable

import pytest

from rigs.avr.binding import Repair
from rigs.avr.build import missing
from tests.rigs.bench import cycles, gaps, powered, ran, values

pytestmark = pytest.mark.skipif(bool(missing()), reason=missing())

Measure = Callable[[Repair], object]
# jmp in the vector table 3, out 1
HANDLER_CYCLES = 4
# The timer is started 1 cycle before the write of PORTD ends; the first match is 500 clocks later.
PERIOD_CYCLES = 500
LONG_CYCLES = 20_000


def response_cycles(repairs: Repair) -> object:
    """From the compare match to the first instruction's end in the handler."""
    avr = ran("compare", repairs)
    started = cycles(avr, "D")[0] - 1
    return cycles(avr, "B")[0] - started - PERIOD_CYCLES


def response_from_sleep_cycles(repairs: Repair) -> object:
    avr = ran("compare", repairs, ("-DASLEEP",))
    started = cycles(avr, "D")[0] - 1
    return cycles(avr, "B")[0] - started - PERIOD_CYCLES


def instructions_after_sei(repairs: Repair) -> object:
    avr = ran("shadow", repairs)
    interrupted = cycles(avr, "B")[0]
    return sum(cycle < interrupted for cycle in cycles(avr, "D"))


def sent_frame_cycles(repairs: Repair) -> object:
    avr = ran("serial", repairs)
    sent = avr.take_timed()["cycle"].astype(int)
    return int(sent[2] - sent[1])


def bytes_the_transmitter_takes_at_once(repairs: Repair) -> object:
    """How many writes of UDR0 went through before the first byte had left."""
    avr = ran("serial", repairs)
    first_left = cycles(avr, "B")[0] + 160
    return sum(cycle < first_left for cycle in cycles(avr, "B"))


def received_frame_cycles(repairs: Repair) -> object:
    avr = ran("serial", repairs)
    start = avr.cycle
    avr.feed(bytes(range(20)))
    avr.run(LONG_CYCLES)
    heard = cycles(avr, "D")
    assert values(avr, "D") == list(range(20))
    assert heard[0] > start
    return round((heard[-1] - heard[0]) / 19)


def kept_by_a_deaf_receiver(repairs: Repair) -> object:
    avr = ran("deaf", repairs)
    avr.feed(bytes([1, 2, 3, 4, 5, 6]))
    avr.run(LONG_CYCLES)
    avr.set_pin("C0", True)
    avr.run(LONG_CYCLES)
    return values(avr, "D")


def overruns_of_a_deaf_receiver(repairs: Repair) -> object:
    avr = ran("deaf", repairs)
    avr.feed(bytes([1, 2, 3, 4, 5, 6]))
    avr.run(LONG_CYCLES)
    avr.set_pin("C0", True)
    avr.run(LONG_CYCLES)
    data_overrun = [bool(status & 0x08) for status in values(avr, "B")]
    return avr.counters.overruns, data_overrun[0], any(data_overrun[1:])


def writes_of_one_value(repairs: Repair) -> object:
    return values(ran("equal", repairs), "B")


def late_interrupts(repairs: Repair) -> object:
    return len(values(ran("late", repairs), "B"))


def matches_at_zero(repairs: Repair) -> object:
    return values(ran("zero", repairs), "B")


def matches_in_ten_turns(repairs: Repair) -> object:
    avr = powered("overflow", repairs)
    avr.run(10 * 65_536 + 1_000)
    # It begins at 0, and matches then.
    return sum(cycle > LONG_CYCLES for cycle in cycles(avr, "B"))


def counts_of_a_stopped_timer(repairs: Repair) -> object:
    avr = ran("stopped", repairs)
    running, (stopped, again) = values(avr, "B")[0], values(avr, "D")
    return running >= 200, stopped > running, stopped == again


def driven_pin_after_a_write_beside_it(repairs: Repair) -> object:
    avr = powered("driven", repairs)
    avr.set_pin("C0", True)
    avr.run(1_000)
    avr.set_pin("C0", False)
    avr.run(1_000)
    return [value & 1 for value in values(avr, "D")]


def flags_left_and_pins_toggled(repairs: Repair) -> object:
    avr = ran("flags", repairs)
    compare_b = 0x04
    return values(avr, "D")[0] & 0x06 == compare_b, values(avr, "B")


def cycles_of_a_bit_set(repairs: Repair) -> object:
    return gaps(ran("store", repairs), "B")


def batches_while_int0_is_low(repairs: Repair) -> object:
    """Whether a low D2 makes the harness look at every single instruction."""
    avr = ran("equal", repairs)
    avr.set_pin("D2", True)
    avr.set_pin("D2", False)
    before = avr.counters.batches
    avr.run(100_000)
    return avr.counters.batches - before < 1_000


FACTS: list[tuple[Repair, Measure, object]] = [
    (Repair.ENTRY, response_cycles, 4 + HANDLER_CYCLES),
    (Repair.SLEEP, response_from_sleep_cycles, 4 + 4 + HANDLER_CYCLES),
    (Repair.SHADOW, instructions_after_sei, 1),
    (Repair.UART, sent_frame_cycles, 160),
    (Repair.UART, received_frame_cycles, 160),
    (Repair.UART, bytes_the_transmitter_takes_at_once, 2),
    (Repair.UART, kept_by_a_deaf_receiver, [1, 2, 6]),
    (Repair.UART, overruns_of_a_deaf_receiver, (3, True, False)),
    (Repair.EQUAL_WRITES, writes_of_one_value, [5, 5, 5]),
    (Repair.LATE_ENABLE, late_interrupts, 1),
    (Repair.CTC_ZERO, matches_at_zero, [1]),
    (Repair.EARLY_MATCH, matches_in_ten_turns, 10),
    (Repair.STOPPED_COUNT, counts_of_a_stopped_timer, (True, True, True)),
    (Repair.DRIVEN_PINS, driven_pin_after_a_write_beside_it, [0]),
    (Repair.FLAG_WRITES, flags_left_and_pins_toggled, (True, [1, 3])),
    (Repair.WRITE_END, cycles_of_a_bit_set, [2]),
    (Repair.LEVEL_POLL, batches_while_int0_is_low, True),
]
NAMES = [measure.__name__ for _, measure, _ in FACTS]


@pytest.mark.parametrize(("repair", "measure", "silicon"), FACTS, ids=NAMES)
def test_repaired_it_is_as_the_silicon(repair: Repair, measure: Measure, silicon: object) -> None:
    assert measure(Repair.ALL) == silicon


@pytest.mark.parametrize(("repair", "measure", "silicon"), FACTS, ids=NAMES)
def test_without_the_repair_it_is_not(repair: Repair, measure: Measure, silicon: object) -> None:
    assert measure(Repair.ALL & ~repair) != silicon


def test_every_repair_has_a_fact() -> None:
    shown = Repair(0)
    for repair, _, _ in FACTS:
        shown |= repair
    assert shown == Repair.ALL
