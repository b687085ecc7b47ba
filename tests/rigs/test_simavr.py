"""The simulated ATmega328P as a place to try firmware: exact, deterministic, and it tells."""

import os
import re
import threading
from pathlib import Path

import numpy as np
import pytest

from rigs.avr import build
from rigs.avr.binding import EVENT, SRAM_END, SRAM_START, Events
from rigs.avr.board import CONTROL, DATA, UNO, Decoder, decode, resets
from rigs.avr.build import RigError, data_symbols, firmware, missing
from rigs.avr.simavr import Avr
from tests.rigs.bench import FIRMWARES, cycles, gaps, powered, ran, values

pytestmark = pytest.mark.skipif(bool(missing()), reason=missing())

FRAME_CYCLES = 160
LONG_CYCLES = 20_000
TIMER1_COMPA, USART_RX, USART_UDRE = 11, 18, 19


# -- time


def test_a_compare_comes_at_the_exact_cycle_every_time() -> None:
    assert gaps(ran("compare"), "B")[:10] == [500] * 10


def test_a_sleeping_core_is_woken_at_the_exact_cycle() -> None:
    avr = ran("compare", flags=("-DASLEEP",))
    assert set(gaps(avr, "B")) == {500}
    assert avr.counters.slept_cycles > avr.cycle // 2


def test_instructions_cost_what_the_data_sheet_says() -> None:
    stated = re.findall(r'COST\((\d+), "(.*)"\);', (FIRMWARES / "costs.c").read_text())
    # The last write of each pair and the first of the next are no measurement.
    measured = [gap - 1 for gap in gaps(ran("costs"), "B")[::2]]
    assert len(stated) > 20
    assert dict(zip([name for _, name in stated], measured, strict=True)) == {
        name: int(cycles) for cycles, name in stated
    }


def test_a_run_ends_where_it_was_told_to() -> None:
    avr = powered("mirror")
    for _ in range(100):
        before = avr.cycle
        avr.run(97)
        assert 97 - 3 <= avr.cycle - before <= 97 + 3
    assert 9_700 <= avr.cycle <= 9_703


def test_the_same_calls_give_the_same_cycles() -> None:
    first, second = powered("serial"), powered("serial")
    for avr in (first, second):
        avr.feed(bytes(range(50)), at_cycle=3_000, gap_cycles=7)
    for _ in range(40):  # turn by turn: they share nothing
        first.run(1_000)
        second.run(1_000)
    assert first.log().tobytes() == second.log().tobytes()
    assert first.take_timed().tobytes() == second.take_timed().tobytes()


def test_slices_change_nothing() -> None:
    whole, sliced = powered("serial"), powered("serial")
    for avr in (whole, sliced):
        avr.feed(b"abcdef", at_cycle=2_000)
    whole.run(10_000)
    while sliced.cycle < whole.cycle:
        sliced.run(13)
    assert sliced.log().tobytes() == whole.log().tobytes()


# -- the wire


def test_bytes_arrive_at_the_baud_rate_and_not_before_their_time() -> None:
    avr = ran("serial")
    start = avr.cycle + 5_000
    avr.feed(b"\x11\x22\x33", at_cycle=start)
    avr.run(LONG_CYCLES)
    assert values(avr, "D") == [0x11, 0x22, 0x33]
    # A polling loop of a few cycles sees each of them soon after its stop bit.
    late = [c - start - FRAME_CYCLES * (i + 1) for i, c in enumerate(cycles(avr, "D"))]
    assert all(0 < cycles_late < 12 for cycles_late in late)


def test_gaps_between_bytes() -> None:
    avr = ran("serial")
    avr.feed(bytes(10), gap_cycles=40)
    avr.run(LONG_CYCLES)
    assert all(abs(gap - FRAME_CYCLES - 40) < 12 for gap in gaps(avr, "D"))


def test_each_sent_byte_has_the_cycle_its_stop_bit_ended() -> None:
    avr = ran("serial")
    sent = avr.take_timed()
    written = cycles(avr, "B")
    assert sent["value"].tolist() == [1, 2, 3]
    # UDR0 was written 1 cycle before PORTB.
    assert int(sent["cycle"][0]) == written[0] - 1 + FRAME_CYCLES
    assert avr.take() == b""


def test_what_is_sent_to_a_receiver_that_is_off_is_lost() -> None:
    avr = powered("equal")
    avr.feed(b"hello")
    avr.run(LONG_CYCLES)
    assert avr.counters.unheard == 5
    assert avr.backlog == 0


def test_at_the_wrong_baud_rate_there_are_framing_errors_and_wrong_bytes() -> None:
    avr = ran("serial")
    avr.set_host_baud(115_200)
    avr.feed(bytes([0x00, 0x55, 0xAA]))
    avr.run(LONG_CYCLES)
    assert avr.counters.framing_errors > 0
    assert values(avr, "D") != [0x00, 0x55, 0xAA]


def test_one_percent_of_baud_rate_does_no_harm() -> None:
    avr = ran("serial")
    avr.set_host_baud(1_010_000)
    avr.feed(bytes(range(0, 250, 10)))
    avr.run(LONG_CYCLES)
    assert values(avr, "D") == list(range(0, 250, 10))
    assert avr.counters.framing_errors == 0


def test_a_receive_interrupt_comes_again_while_bytes_wait() -> None:
    avr = ran("levels")
    avr.feed(b"\x11\x22\x33")  # the firmware lets them wait until C0 goes high
    avr.run(LONG_CYCLES)
    assert values(avr, "D") == []
    avr.set_pin("C0", True)
    avr.run(LONG_CYCLES)
    assert values(avr, "D") == [0x11, 0x22, 0x33]
    assert avr.vectors()[USART_RX].count == 3


def test_a_transmit_interrupt_comes_until_it_is_switched_off() -> None:
    avr = ran("levels")
    avr.set_pin("C0", True)
    avr.run(LONG_CYCLES)
    sent = avr.take_timed()
    assert sent["value"].tolist() == [1, 2, 3, 4, 5]
    assert set(np.diff(sent["cycle"].astype(np.int64))) == {FRAME_CYCLES}
    assert avr.vectors()[USART_UDRE].count == 6  # the last one only switches it off


def test_a_host_that_stops_sending() -> None:
    avr = ran("serial")
    avr.feed(bytes(range(100)))
    avr.run(FRAME_CYCLES * 10)
    avr.drop_backlog()
    avr.run(LONG_CYCLES)
    assert 9 <= len(values(avr, "D")) <= 11


# -- the pins


@pytest.mark.parametrize("cycle", range(2_000, 2_008))
def test_a_pin_changes_at_the_exact_cycle(cycle: int) -> None:
    avr = powered("mirror")
    avr.schedule([(cycle, "C0", True), (cycle + 100, "C0", False)])
    avr.run(4_000)
    log = avr.writes("D")
    high = [int(c) for c in log["cycle"][log["value"] & 1 == 1]]
    # IN begins 2 cycles before its OUT ends, and comes every 2 cycles.
    assert high[0] - 2 in (cycle, cycle + 1)
    assert high[-1] - 2 in (cycle + 98, cycle + 99)


def test_a_contact_closes_at_the_given_step() -> None:
    avr = powered("clock")
    avr.contact("B", 0x01, 0x01, count=10, pin="C0", level=True)
    avr.run(2_000)
    assert values(avr, "D")[:12] == [0] * 9 + [1] * 3


def test_a_contact_that_is_slow_to_close() -> None:
    avr = powered("clock")
    period_cycles = cycles(ran("clock"), "D")[1] - cycles(ran("clock"), "D")[0]
    avr.contact("B", 1, 1, count=10, pin="C0", level=True, delay_cycles=2 * period_cycles)
    avr.run(2_000)
    assert values(avr, "D")[:14] == [0] * 11 + [1] * 3


def test_a_watcher_may_act_in_the_middle_of_the_run() -> None:
    avr = powered("clock")
    rises: list[int] = []

    def watcher(cycle: int, port: str, value: int) -> None:
        assert (port, value) == ("B", 1)
        rises.append(cycle)
        avr.set_pin("C0", len(rises) % 2 == 1)
        if len(rises) == 20:
            avr.stop()

    number = avr.watch("B", 0x01, 0x01, watcher)
    avr.run(1_000_000)
    assert len(rises) == 20 == avr.watched(number)
    assert avr.cycle - rises[-1] <= 2
    assert values(avr, "D") == [1, 0] * 9 + [1]
    avr.unwatch(number)
    avr.run(1_000)
    assert len(rises) == 20


# -- resets, memory, interrupts


def test_the_watchdog_resets_after_its_time() -> None:
    avr = powered("watchdog")
    avr.run(600_000)
    (power_on, cause), (bitten, why), *_ = resets(avr.log())
    assert (power_on, cause, why) == (0, 0x01, 0x08)
    armed = cycles(avr, "D")[1]
    assert abs(bitten - armed - 256_000) <= 10  # 16 ms: 2048 beats of 128 kHz
    assert values(avr, "B")[:2] == [0x01, 0x08]
    assert values(avr, "D")[2] == 0x5A  # memory outlives a reset
    assert avr.counters.resets >= 2


def test_a_reset_lets_go_of_the_pins() -> None:
    avr = powered("watchdog")
    avr.run(300_000)
    (_, _), (bitten, _), *_ = resets(avr.log())
    assert avr.writes("d")["value"].tolist() == [0xFF, 0xFF]
    assert int(avr.writes("d")["cycle"][1]) > bitten


def test_the_reset_pin() -> None:
    avr = ran("watchdog")
    avr.reset()
    avr.run(1_000)
    assert [cause for _, cause in resets(avr.log())] == [0x01, 0x02]
    assert values(avr, "B") == [0x01, 0x02]


def test_levels_from_outside_outlive_a_reset() -> None:
    avr = ran("mirror")
    avr.set_pin("C2", True)
    avr.reset()
    avr.run(2_000)
    assert values(avr, "D")[-1] == 0x04


def test_the_deepest_stack_is_remembered() -> None:
    shallow = ran("deep", flags=("-DDEPTH=100",))
    deep = ran("deep", flags=("-DDEPTH=600",))
    assert shallow.stack_free - deep.stack_free == 500
    frame_and_calls = 20
    ram = SRAM_END - SRAM_START
    assert ram - 100 - 100 - frame_and_calls <= shallow.stack_free <= ram - 100 - 100


def test_memory_can_be_read() -> None:
    avr = ran("deep", flags=("-DDEPTH=100",))
    assert avr.peek(SRAM_START, 2) == bytes([3, 0])
    with pytest.raises(RigError, match="no data memory at 0x8ff to 0x901"):
        avr.peek(0x8FF, 2)


def test_variables_have_names() -> None:
    flags = ("-DDEPTH=100",)
    address = data_symbols(firmware(FIRMWARES / "deep.c", flags=flags))["data"]
    assert ran("deep", flags=flags).peek(address, 2) == bytes([3, 0])


def test_interrupts_are_counted_and_timed() -> None:
    use = ran("compare").vectors()[TIMER1_COMPA]
    assert use.count >= 10
    assert use.max_cycles == 12  # entry 4, jmp 3, out 1, reti 4
    assert use.total_cycles == 12 * use.count


def test_a_core_asleep_with_interrupts_off_has_stopped() -> None:
    avr = powered("halt")
    assert not avr.run(LONG_CYCLES)


def test_what_is_no_image_is_refused() -> None:
    with pytest.raises(RigError, match=r"common\.h is no image"):
        Avr(FIRMWARES / "common.h")


def test_pins_have_names() -> None:
    avr = powered("equal")
    with pytest.raises(RigError, match="no pin 'A0'"):
        avr.set_pin("A0", True)


# -- the plug


def test_writes_are_put_together_to_the_registers_of_a_parallel_port() -> None:
    avr = ran("plug")
    seen = told(avr.log())
    strobed = [(CONTROL, 0x0B), (CONTROL, 0x0A)]
    bytes_out = [0x49, 0x49, 0xC3, 0xC4]
    expected = [access for byte in bytes_out for access in [(DATA, byte), *strobed]]
    assert seen == [*expected, (CONTROL, 0x02), (CONTROL, 0x0A)]


def test_the_two_halves_of_a_byte_are_a_few_cycles_apart() -> None:
    data = decode(ran("plug").log())
    data = data[data["register"] == DATA]
    assert data["spread"].tolist() == [2, 2, 2, 2]


def test_a_log_decoded_in_pieces_is_the_same() -> None:
    log = ran("plug").log()
    whole = decode(log)
    for piece in (1, 2, 3, 7):
        decoder = Decoder(UNO)
        pieces = [log[i : i + piece] for i in range(0, len(log), piece)]
        parts = [decoder.decode(part, int(part["cycle"][-1])) for part in pieces]
        parts.append(decoder.decode(log[:0]))
        assert b"".join(part.tobytes() for part in parts) == whole.tobytes()


def test_nothing_decodes_to_nothing() -> None:
    assert len(decode(events())) == 0


def test_a_direction_set_before_the_latch_is_seen_as_a_strobe() -> None:
    careless = events((10, "b", 0x1F), (20, "B", 0x04))
    careful = events((10, "B", 0x04), (20, "b", 0x1F))
    assert told(careless) == [(CONTROL, 0x0B), (CONTROL, 0x0A)]
    assert told(careful) == []


def test_after_a_reset_the_pull_up_keeps_the_strobe_still() -> None:
    running = [(0, "B", 0x04), (1, "b", 0x1F), (2, "d", 0xFC), (10, "D", 0xFC), (12, "B", 0x07)]
    again = [(100, "R", 8), (200, "B", 0x04), (201, "b", 0x1F), (202, "d", 0xFC)]
    assert told(events(*running)) == [(DATA, 0xFF)]
    assert told(events(*running, *again)) == [(DATA, 0xFF)]


def test_either_half_may_come_first() -> None:
    out = [(0, "B", 0x04), (1, "b", 0x1F), (2, "d", 0xFC)]
    assert told(events(*out, (50, "B", 0x05), (53, "D", 0x04))) == [(DATA, 0x41)]
    assert told(events(*out, (50, "B", 0x05), (56, "D", 0x04))) == [(DATA, 0x40), (DATA, 0x41)]


def test_status_register_to_pins() -> None:
    idle = dict(UNO.status_pins(0x80))
    contact = dict(UNO.status_pins(0x00))
    assert [pin for pin in UNO.status if idle[pin] != contact[pin]] == ["C0"]
    assert contact["C0"]  # pin 11 is inverted: bit 7 clear, pin high


def told(log: Events) -> list[tuple[int, int]]:
    """What a parallel port would have been told: (register, value)."""
    return [(int(access["register"]), int(access["value"])) for access in decode(log)]


def events(*rows: tuple[int, str, int]) -> Events:
    log = np.zeros(len(rows), EVENT)
    for i, (cycle, kind, value) in enumerate(rows):
        log[i]["cycle"], log[i]["kind"], log[i]["value"] = cycle, ord(kind), value
    return log


# -- building


def test_threads_may_build_the_same_file_at_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(build, "CACHE", tmp_path / "cache")
    built: list[Path] = []
    threads = [
        threading.Thread(target=lambda: built.append(build.host_program.__wrapped__()))
        for _ in range(4)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(built) == 4
    assert os.access(built[0], os.X_OK)
    assert list((tmp_path / "cache").iterdir()) == [built[0]]
