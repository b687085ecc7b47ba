"""Jog keys pressed while the machine moves: nothing is dropped without a word."""

from fraese.config import Config
from tests.ui.helpers import bench, play

SLOW = Config.model_validate({"jog": {"feed_mm_min": 60}})


def test_taps_add_up_and_what_waits_is_shown() -> None:
    async def scene() -> None:
        async with bench(clock="paced", config=SLOW) as b:
            await b.press("5", "right", "right", "right", "up")
            await b.wait(lambda: "waiting: X +2, Y +1" in b.text("#job"))
            await b.press("escape")
            await b.settled()
            assert "waiting" not in b.text("#job")
            assert b.moved_steps[1] == 0

    play(scene)


def test_the_opposite_key_turns_round_and_says_what_it_left_out() -> None:
    async def scene() -> None:
        async with bench(clock="paced", config=SLOW) as b:
            await b.press("5", "right", "right", "left")
            await b.settled()
            assert b.moved_steps == (0, 0, 0)
            assert "1 press that had not begun is left out" in b.text("#message")
            assert b.mill.look().lost_steps == (0, 0, 0)

    play(scene)


def test_the_factor_goes_when_the_keys_rest() -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.press("1", *["right"] * 21)
            await b.settled()
            await b.wait(lambda: b.text("#width-note") == "")
            await b.jog("right")
            assert b.moved_steps[0] == 20 + 10 + 1

    play(scene)
