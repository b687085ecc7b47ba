"""The Card seam: one suite, every peer."""

import itertools
from collections.abc import Callable

import pytest

from fraese.motor.cards.control import OutputPin
from fraese.motor.cards.smc1500 import SmcCard
from fraese.motor.cards.stepdir import STEPDIR_PROFILES, StepDirCard
from fraese.motor.phases import PHASE_TABLES
from fraese.motor.seams import CONTROL, DATA, STATUS, Card, Entries, IdleLevel
from tests.beside import example

SMC_OUTPUTS = (OutputPin(14), OutputPin(17, active_high=False))
STEPDIR_OUTPUTS = (OutputPin(1), OutputPin(14, active_high=False))

PEERS: dict[str, Callable[[], Card]] = {
    **{
        f"smc {name}": lambda table=table: SmcCard(table, 50, outputs=SMC_OUTPUTS)  # type: ignore[misc]
        for name, table in PHASE_TABLES.items()
    },
    **{
        f"stepdir {name}": lambda profile=profile: StepDirCard(  # type: ignore[misc]
            profile, outputs=STEPDIR_OUTPUTS
        )
        for name, profile in STEPDIR_PROFILES.items()
    },
    "stepdir with enable": lambda: StepDirCard(outputs=STEPDIR_OUTPUTS, enable=1),
    "stepdir upside down": lambda: StepDirCard(clock_idles_high=True, forward_high=False),
    "smc, two motors": lambda: SmcCard(motors=2),
    "uln2003, of a package of its own": lambda: example("uln2003", "fraese_uln2003.card").UlnCard(
        SMC_OUTPUTS
    ),
}


@pytest.fixture(params=PEERS)
def card(request: pytest.FixtureRequest) -> Card:
    return PEERS[request.param]()


def step(card: Card, moving: int) -> Entries:
    """Make one step."""
    entries = card.tick(moving)
    card.stepped(moving)
    return entries


def everything(card: Card) -> Entries:
    """What a card says in a short life."""
    lines = [
        *card.idle(IdleLevel.OFF),
        *card.energise(),
        *card.set_outputs(0b11, 0b11),
        *card.signals(True, True),
    ]
    for directions in itertools.product((-1, 0, 1), repeat=card.motors):
        lines += card.begin(directions, 0)
        moving = sum(1 << motor for motor, d in enumerate(directions) if d)
        lines += (*step(card, moving), *card.fall)
    lines += (*card.signals(False, False), *card.set_outputs(~0, 0))
    lines += (*card.idle(IdleLevel.HOLD), *card.idle(IdleLevel.OFF))
    return tuple(lines)


class TestCardContract:
    def test_values_fit_their_registers(self, card: Card) -> None:
        for register, value in everything(card):
            assert register in (DATA, STATUS, CONTROL)
            if register == DATA:
                assert 0 <= value <= 0xFF
            elif register == CONTROL:
                assert 0 <= value <= 0x0F
            else:
                assert -1 <= value < card.motors

    def test_a_tick_is_read_after_its_steps(self, card: Card) -> None:
        card.begin([1] * card.motors, 0)
        for moving in range(1 << card.motors):
            assert step(card, moving)[-1].register == STATUS

    def test_a_tick_without_steps_only_reads(self, card: Card) -> None:
        card.begin([0] * card.motors, 0)
        assert {entry.register for entry in card.tick(0)} == {STATUS}

    def test_phases_count_steps_both_ways(self, card: Card) -> None:
        start = card.phases()
        card.begin([1] * card.motors, 0)
        everybody = (1 << card.motors) - 1
        step(card, everybody)
        assert all(a != b for a, b in zip(start, card.phases(), strict=True))
        card.begin([-1] * card.motors, card.motors - 1)
        step(card, everybody)
        assert card.phases() == start

    def test_phases_that_were_kept_go_on_where_they_were(self, card: Card) -> None:
        card.begin([1] * card.motors, 0)
        for _ in range(3):
            step(card, 1)
        kept = card.phases()
        ahead = card.tick(1)
        card.set_phases(kept)
        assert card.phases() == kept
        assert card.tick(1) == ahead

    def test_what_a_step_will_write_can_be_asked_for_ahead(self, card: Card) -> None:
        card.begin([1] * card.motors, 0)
        before = card.phases()
        ahead = card.tick(1)
        assert card.tick(1) == ahead
        assert card.phases() == before
        card.stepped(1)
        assert card.phases() != before

    def test_there_and_back_writes_the_same_way_again(self, card: Card) -> None:
        def there_and_back() -> list[Entries]:
            written = []
            for direction in (1, -1):
                card.begin([direction] * card.motors, 0)
                written += [step(card, 1) for _ in range(24)]
            return written

        assert there_and_back() == there_and_back()

    def test_begin_says_nothing_twice(self, card: Card) -> None:
        card.begin([1] * card.motors, 0)
        assert card.begin([1] * card.motors, 0) == ()

    def test_signals_and_outputs_say_only_what_changes(self, card: Card) -> None:
        card.signals(True, True)
        assert card.signals(True, True) == ()
        card.set_outputs(0b11, 0b10)
        assert card.set_outputs(0b11, 0b10) == ()
        assert card.set_outputs(0, 0b01) == ()

    def test_outputs_survive_steps_and_rest(self, card: Card) -> None:
        on = card.set_outputs(0b01, 0b01)
        if not on:
            pytest.skip("no free outputs")
        changed = on[-1].value
        off = card.set_outputs(0b01, 0)[-1].value
        bit = changed ^ off
        card.set_outputs(0b01, 0b01)
        card.begin([1] * card.motors, 0)
        later = (*card.signals(True, True), *card.tick(1), *card.idle(IdleLevel.OFF))
        assert all(e.value & bit == changed & bit for e in later if e.register == CONTROL)

    def test_clock_lines_and_their_timing_belong_together(self, card: Card) -> None:
        assert card.setup_cycles >= 0
        assert bool(card.fall) == (card.pulse_cycles > 0)

    def test_a_fall_after_a_fall_changes_nothing(self, card: Card) -> None:
        card.begin([1] * card.motors, 0)
        rest = card.fall
        step(card, 1)
        assert card.fall == rest
