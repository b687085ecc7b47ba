"""While a program waits for a person, he moves by hand; it goes on at the same place of it."""

from collections.abc import Callable
from pathlib import Path

import pytest

from fraese.assembly import Plant
from fraese.control.jogging import Jogs
from fraese.control.state import Status
from fraese.errors import StateError
from fraese.program.kept import KeptPrograms
from fraese.program.program import open_program
from fraese.program.resumption import Resumption
from tests.helpers import carriages, homed, look, program, run_program

PART = "G0 Z5\nG0 X10 Y10\nT1 M6\nG1 Z-1 F600\nX20\nG55\nG54\nG0 Z5\nM2\n"


class Person:
    """Does one thing after the other, each when the machine waits for him."""

    def __init__(self, made: Plant, *deeds: Callable[[], object]) -> None:
        self.plant, self.controller = made, made.controller
        self.asked: list[str] = []
        self._deeds = list(deeds)
        self.controller.set_break_key(self._look)

    def _look(self) -> None:
        question = self.controller.question
        if not question:
            return
        if not self.asked or self.asked[-1] != question:
            self.asked.append(question)
        (self._deeds.pop(0) if self._deeds else self.controller.answer)()


def on_the_work() -> Plant:
    """Referenced; the top of the work is at Z -30."""
    made = homed()
    made.controller.move_to({"z": -30}, machine_coordinates=True)
    made.controller.run()
    made.controller.set_zero("z")
    return made


def machine_mm(made: Plant) -> tuple[float, ...]:
    return made.controller.state().position_mm


def test_a_longer_tool_is_touched_off_and_the_program_goes_on_with_it(tmp_path: Path) -> None:
    made = on_the_work()
    controller = made.controller
    shown: list[tuple[float, ...]] = []
    person = Person(
        made,
        lambda: controller.jog("z", 20),
        lambda: controller.jog("x", -5),
        lambda: controller.move_to({"z": -20}, machine_coordinates=True),
        lambda: controller.set_zero("z"),
        lambda: shown.append(controller.state().work_mm),
        controller.answer,
        controller.answer,
    )
    assert run_program(made, program(tmp_path, PART)) is Status.OK
    assert shown == [(5, 10, 0)]
    tool = "Tool change in line 3: put in tool 1."
    back = person.asked[-1]
    assert set(person.asked) == {tool, back}
    assert back == (
        "Back to the work: rapid to X 5.000 Y 10.000 Z 0.000 mm; rapid to X 10.000 Y 10.000 Z 0.000"
        " mm; feed 300 mm/min to X 10.000 Y 10.000 Z -15.000 mm (machine): go?"
    )
    # At the end it stands 5 mm above the work, whose top the new tool has at -20.
    assert machine_mm(made) == pytest.approx((20, 10, -15))
    assert controller.state().work_mm == pytest.approx((20, 10, 5))
    assert controller.position.position_steps == tuple(
        round(a - b) for a, b in zip(carriages(made), (400, 400, 11_600), strict=True)
    )
    assert look(made).lost_steps == (0, 0, 0)


def test_the_deepest_place_is_that_of_the_new_tool(tmp_path: Path) -> None:
    made, lowest = on_the_work(), []
    controller = made.controller
    controller.set_show_pos(
        lambda: lowest.append(machine_mm(made)[2]) if machine_mm(made)[0] > 10.5 else None
    )
    Person(made, lambda: controller.jog("z", 3), lambda: controller.set_zero("z"))
    assert run_program(made, program(tmp_path, PART)) is Status.OK
    # -25 + 3 is the new zero; the program goes 1 below it.
    assert min(lowest) == pytest.approx(-23)
    assert machine_mm(made)[2] == pytest.approx(-22 + 5)


def test_whoever_moves_once_more_is_shown_the_way_once_more(tmp_path: Path) -> None:
    made = on_the_work()
    controller = made.controller
    person = Person(
        made,
        lambda: controller.jog("y", 5),
        controller.answer,
        lambda: controller.jog("y", 5),
        controller.answer,
        controller.answer,
    )
    assert run_program(made, program(tmp_path, "G0 X1 Y1\nM0\nG0 X3\nM2\n")) is Status.OK
    ways = [question for question in person.asked if question.startswith("Back")]
    assert ["Y 6.000" in way for way in ways] == [True, False]
    assert "Y 11.000" in ways[1]
    assert machine_mm(made)[:2] == (3, 1)


def test_whoever_does_nothing_is_asked_nothing_more(tmp_path: Path) -> None:
    made = on_the_work()
    person = Person(made)
    assert run_program(made, program(tmp_path, PART)) is Status.OK
    assert person.asked == ["Tool change in line 3: put in tool 1."]


def test_nothing_else_is_possible_meanwhile(tmp_path: Path) -> None:
    made = on_the_work()
    controller, refused = made.controller, []
    other = program(tmp_path, "G0 X1\nM2\n", "other.ngc")

    def refuse() -> None:
        commands: tuple[Callable[[], object], ...] = (
            lambda: controller.home(["x"]),
            lambda: controller.set_zero("x"),
            lambda: controller.set_zero("xyz"),
            lambda: controller.run_curve([(1, 1, 1)]),
            lambda: other.start(controller),
        )
        for command in commands:
            with pytest.raises(StateError) as error:
                command()
            refused.append(str(error.value))

    Person(made, refuse)
    assert run_program(made, program(tmp_path, PART)) is Status.OK
    assert "only the zero of Z can be set now, not that of X" in refused[1]
    assert machine_mm(made) == pytest.approx((20, 10, -25))


def test_a_stop_ends_the_jog_and_the_question_waits_on(tmp_path: Path) -> None:
    made = on_the_work()
    controller = made.controller
    slices = 0

    def soon() -> None:
        nonlocal slices
        if person.asked and not controller.question and machine_mm(made)[0] < 8:
            slices += 1
            if slices == 1:
                controller.cancel()

    person = Person(made, lambda: controller.jog("x", -10), controller.answer, controller.answer)

    def both() -> None:
        soon()
        person._look()

    controller.set_break_key(both)
    part = program(tmp_path, PART)
    assert run_program(made, part) is Status.OK
    assert slices
    assert machine_mm(made) == pytest.approx((20, 10, -25))
    assert controller.state().work.system == "G54"
    # Offsets are followed to the end, whatever of the jog was dropped.
    assert controller.state().offset_mm == pytest.approx((0, 0, -30))


def test_jog_keys_work_while_it_waits(tmp_path: Path) -> None:
    made = on_the_work()
    jogs = Jogs(made.controller, lambda text: None, lambda text: None)

    def press() -> None:
        for _ in range(3):
            jogs.press("x", mm=1.0)
        jogs.press("y", mm=-1.0)
        jogs.start()

    person = Person(made, press, made.controller.answer, made.controller.answer)
    assert run_program(made, program(tmp_path, PART)) is Status.OK
    assert "X 13.000 Y 9.000" in person.asked[-1]
    assert machine_mm(made) == pytest.approx((20, 10, -25))


@pytest.mark.parametrize("answered", [False, True])
def test_a_program_that_is_cut_short_afterwards_keeps_the_tool(
    tmp_path: Path, answered: bool
) -> None:
    made = on_the_work()
    kept, controller = KeptPrograms(tmp_path / "kept"), made.controller
    path = tmp_path / "part.ngc"
    path.write_text(PART)

    def cancel() -> None:
        controller.cancel()

    def cancel_later() -> None:
        controller.answer()
        controller.set_break_key(lambda: controller.cancel() if machine_mm(made)[0] > 14 else None)

    deeds = (lambda: controller.jog("z", 10), lambda: controller.set_zero("z"))
    last = (controller.answer, cancel_later) if answered else (cancel,)
    Person(made, *deeds, *last)
    part = open_program(path, kept=kept)
    part.check(controller)
    part.start(controller)
    assert controller.run() is Status.CANCEL
    assert controller.state().offset_mm[2] == pytest.approx(-15)
    left = controller.state().cut_short
    assert left is not None
    assert left.line == (5 if answered else 3)
    controller.acknowledge()
    Person(made)
    Resumption.of(controller, kept).start(controller)
    assert controller.run() is Status.OK
    assert controller.state().work_mm == pytest.approx((20, 10, 5))
    assert machine_mm(made) == pytest.approx((20, 10, -10))


def test_under_cutter_compensation_no_tool_can_be_touched_off(tmp_path: Path) -> None:
    """A move that was read already would go down to where the old tool was."""
    made, lowest = on_the_work(), []
    controller = made.controller
    text = "G0 X5 Y5 Z5\nG41.1 D2\nG1 X10 F600\nX20\nM0\nX30\nG40\nG0 X40\nM2\n"
    Person(made, lambda: controller.jog("z", 10), lambda: controller.set_zero("z"))
    controller.set_show_pos(
        lambda: lowest.append(machine_mm(made)[2]) if machine_mm(made)[0] > 20.1 else None
    )
    assert run_program(made, program(tmp_path, text)) is Status.ERROR
    assert "cutter compensation" in controller.state().message
    assert lowest == []


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("M0", "Program stop in line 2: go on?"),
        ("M0 (turn it over)", "Program stop in line 2 (turn it over): go on?"),
        ("M0 ; turn it over", "Program stop in line 2 (turn it over): go on?"),
        ("(MSG, turn it over) M0", "Program stop in line 2 (turn it over): go on?"),
        ("M0 (PRINT,#5400)(DEBUG,x)", "Program stop in line 2: go on?"),
        (f"M0 ({'word ' * 100})", f"Program stop in line 2 ({'word ' * 14}word …): go on?"),
        ("T3 M6 (6 mm)(long)", "Tool change in line 2 (6 mm, long): put in tool 3."),
    ],
)
def test_what_the_program_says_beside_a_question_is_asked(
    tmp_path: Path, line: str, said: str
) -> None:
    made = homed()
    asked: list[str] = []

    def look() -> None:
        if made.controller.question:
            asked.append(made.controller.question)
            made.controller.answer()

    made.controller.set_break_key(look)
    assert run_program(made, program(tmp_path, f"G21\n{line}\nM2\n")) is Status.OK
    assert asked[0] == said
