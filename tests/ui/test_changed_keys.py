"""Keys that somebody has changed: checked, and true wherever a key is named."""

import pytest

from fraese.errors import ConfigError
from fraese.phrases import speak
from fraese.ui.dialogs.goto import GoToDialog
from fraese.ui.dialogs.help import HelpPage
from fraese.ui.keyrows import Area, KeyTable
from fraese.ui.keyrows.changes import TOGETHER
from fraese.ui.keyrows.naming import key_named, shown
from fraese.ui.shape import AxisShape, Shape
from fraese.ui.views import VIEWS
from tests.ui.helpers import bench, play

MILL = Shape(tuple(AxisShape(name, "mm", 0.005) for name in "xyz"), "half-step")
#: Files of people name these: a new word in a title must not take a name away from them.
NAMES = """
stop hold_go_on acknowledge jog_z_plus jog_z_minus quit jog_x_minus jog_x_plus jog_y_minus
jog_y_plus go_to reference zero_x zero_y zero_z zero_all open_program start_program next_picture
next_theme switch_test ignore_switches log_on_or_off help view_move view_program view_calibrate
view_bench view_log next_view view_before type_a_line set_position zero_x_and_y go_to_work_zero
work_offsets probe lift_the_tool undo_zero resume_program after_a_crash slower_feed faster_feed
as_programmed slower_rapids faster_rapids wider_step narrower_step step_width_1 step_width_2
step_width_3 step_width_4 step_width_5 path_up path_down program_single_block
program_optional_stop program_block_delete program_other_side program_all_of_it program_nearer
program_further_away program_look_left program_look_right program_look_up program_look_down
program_lines_up program_lines_down quit_at_once calibrate_reference_run calibrate_measure_travel
calibrate_steps_per_mm calibrate_backlash_by_switch calibrate_backlash_by_gauge
calibrate_repeat_a_switch calibrate_frequency_test calibrate_switch_test calibrate_axis_before
calibrate_next_axis calibrate_it_resonates calibrate_it_stalls calibrate_take_back_a_mark
calibrate_other_proposal calibrate_up calibrate_down calibrate_write bench_motor_before
bench_next_motor bench_a_step_back bench_a_step_ahead bench_a_turn_back bench_a_turn_ahead
bench_slower bench_faster bench_next_phase_table bench_press_a_switch bench_block_the_axis
log_filter log_copy log_up_a_line log_down_a_line log_up log_down
"""


def table(**changes: list[str]) -> KeyTable:
    return KeyTable(MILL, changes=changes)


def refusal(**changes: list[str]) -> str:
    with pytest.raises(ConfigError) as refused:
        table(**changes)
    return str(refused.value)


def test_every_action_has_a_name_of_its_own_that_stays() -> None:
    names = [row.name for row in table().commands]
    assert len(names) == len(set(names))
    assert set(NAMES.split()) <= set(names)


def test_names_are_the_same_in_german() -> None:
    speak("de")
    try:
        assert set(NAMES.split()) <= {row.name for row in table().commands}
    finally:
        speak("en")


def test_what_is_shown_of_a_key_is_what_its_name_makes() -> None:
    assert all(row.shown in map(shown, row.each) for row in table().rows if row.each)
    assert [shown(key) for key in ("ctrl+x", "f12", "ctrl+left", "shift+tab", "plus", "ä")] == [
        "^x", "F12", "^←", "Shift+Tab", "+", "ä",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("g", "g"), ("G", "G"), ("+", "plus"), (",", "comma"), (" ", "space"), ("PageUp", "pageup"),
        ("F8", "f8"), ("ctrl+g", "ctrl+g"), ("ctrl+i", "tab"), ("ctrl+m", "enter"),
        ("Ctrl+Left", "ctrl+left"), ("pgup", None), ("", None), ("\x1b", None), ("<any>", None),
    ],
)  # fmt: skip
def test_a_key_is_written_as_a_character_or_by_its_name(text: str, key: str | None) -> None:
    assert key_named(text) == key


def test_a_changed_key_is_in_every_place() -> None:
    rows = table(go_to=["f8", "g"], jog_x_plus=["right", "d"])
    assert rows.said("go_to") == "F8"
    assert [row.keys for row in rows.listed if row.name == "jog_x_plus"] == ["right,d"]
    go_to = next(row for row in rows.of(Area.MACHINE) if row.name == "go_to")
    assert (go_to.each, go_to.all_shown) == (("f8", "g"), "F8 g")
    assert table(view_move=["f9"]).views["move"].shown == "F9"


def test_two_actions_may_swap_their_keys() -> None:
    rows = table(go_to=["o"], open_program=["g"])
    assert (rows.said("go_to"), rows.said("open")) == ("o", "g")


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"fly": ["g"]}, "keys.fly: no action is called that; fraese config keys lists them all."),
        ({"goto": ["g"]}, "keys.goto: no action is called that, perhaps go_to;"),
        ({"go_to": ["pgup"]}, 'keys.go_to: "pgup" is no key; write a character'),
        ({"go_to": ["escape"]}, "keys.go_to: escape always stops; choose another key."),
        ({"go_to": ["f8", "ctrl+c"]}, "keys.go_to: ctrl+c always stops; choose another key."),
        ({"go_to": ["ctrl+p"]}, "keys.go_to: ctrl+p works everywhere; choose another key."),
        ({"go_to": ["ctrl+q"]}, "keys.go_to: ctrl+q works everywhere; choose another key."),
        ({"stop": ["f9"]}, "keys.stop: what works everywhere keeps its keys (escape ctrl+c)"),
        ({"quit_at_once": ["f9"]}, "keys.quit_at_once: what works everywhere keeps its keys"),
        (
            {"go_to": ["o"]},
            "keys.go_to: o is the key of open_program already; give that one another key, too.",
        ),
        ({"go_to": ["f8"], "reference": ["f8"]}, "F8 is the key of reference already"),
        ({"hold_go_on": ["s"]}, "keys.hold_go_on: s is the key of start_program already"),
        ({"program_nearer": ["o"]}, "keys.program_nearer: o is the key of open_program already"),
        ({"go_to": ["ctrl+i"]}, "keys.go_to: Tab is the key of next_view already"),
    ],
)
def test_what_cannot_be_is_said_in_a_sentence(changes: dict[str, list[str]], sentence: str) -> None:
    assert sentence in refusal(**changes)


def test_the_same_key_in_two_views_is_no_clash() -> None:
    assert table(go_to=["c"]).said("go_to") == "c", "c copies, in the view Log only"


def test_what_is_seen_at_once_is_what_the_views_say() -> None:
    seen = {frozenset({Area.EVERYWHERE, Area.VIEWS, v.AREA, *v.ALSO}) for v in VIEWS.values()}
    assert seen == set(TOGETHER)


def test_the_changed_key_works_and_the_old_one_does_not() -> None:
    async def scene() -> None:
        async with bench(keys=table(go_to=["f8"], jog_x_plus=["d"])) as b:
            await b.settled()
            await b.press("g", "right")
            await b.settled()
            assert b.app.screen is b.view
            assert b.moved_steps == (0, 0, 0)
            await b.jog("d")
            assert b.moved_steps[0] > 0
            await b.press("f8")
            assert isinstance(b.app.screen, GoToDialog)
            await b.press("escape", "f1")
            await b.wait(lambda: isinstance(b.app.screen, HelpPage))
            await b.press("escape")
            stop = next(iter(b.app._keys.of(Area.EVERYWHERE)))
            assert stop.each == ("escape", "ctrl+c")

    play(scene)


def test_the_app_names_the_changed_key_in_its_sentences() -> None:
    async def scene() -> None:
        async with bench(keys=table(undo_zero=["f9"])) as b:
            await b.jog("right", "X")
            assert "F9 undoes it" in b.app.view.said[0]

    play(scene)
