"""The tool table changed by hand: kept, or not in force."""

from collections.abc import Mapping
from pathlib import Path

import pytest

from fraese.assembly import Plant, assemble
from fraese.config import Config
from fraese.control.state import Status
from fraese.control.tooltable import (
    Tool,
    clear_tool,
    set_by_programs,
    store_tool,
    tool_table,
)
from fraese.errors import ConfigError, StateError, UsageError
from fraese.program.context import ProgramContext
from fraese.program.typed import run_text

Values = Mapping[str, float | str | None]


class Keeper:
    """Remembers what it was told to write."""

    def __init__(self, trouble: str = "") -> None:
        self.written: list[Values] = []
        self._trouble = trouble

    def write(self, values: Values) -> None:
        if self._trouble:
            raise ConfigError(self._trouble)
        self.written.append(values)


def plant(**tools: dict[str, object]) -> Plant:
    table = {name.removeprefix("t"): values for name, values in tools.items()}
    return assemble(Config.model_validate({"tools": table}))


def test_a_new_tool_is_written_and_the_next_program_finds_it() -> None:
    made, keeper = plant(), Keeper()
    store_tool(made.controller, Tool(3, 12.5, 6.0, "end mill"), keeper.write)
    assert keeper.written == [
        {"tools.3.length_mm": 12.5, "tools.3.diameter_mm": 6.0, "tools.3.remark": "end mill"}
    ]
    assert tool_table(made.controller) == [Tool(3, 12.5, 6.0, "end mill")]
    assert ProgramContext.of(made.controller).config.tools["3"].length_mm == 12.5
    made.close()


def test_only_what_changed_is_written_under_the_name_in_the_file() -> None:
    made, keeper = plant(t03={"length_mm": 1, "diameter_mm": 2}), Keeper()
    store_tool(made.controller, Tool(3, 1.0, 4.0), keeper.write)
    assert keeper.written == [{"tools.03.diameter_mm": 4.0}]
    store_tool(made.controller, Tool(3, 1.0, 4.0), keeper.write)
    assert len(keeper.written) == 1
    clear_tool(made.controller, 3, keeper.write)
    assert keeper.written[-1] == {"tools.03": None}
    assert tool_table(made.controller) == []
    made.close()


def test_what_cannot_be_written_is_not_in_force() -> None:
    made, keeper = plant(t1={}), Keeper("fraese.toml: cannot be written.")
    with pytest.raises(ConfigError):
        store_tool(made.controller, Tool(1, 5.0), keeper.write)
    with pytest.raises(ConfigError):
        clear_tool(made.controller, 1, keeper.write)
    assert tool_table(made.controller) == [Tool(1)]
    made.close()


@pytest.mark.parametrize(
    ("tool", "sentence"),
    [
        (Tool(0), "numbered from 1"),
        (Tool(1, diameter_mm=-1.0), "not negative"),
        (Tool(1, length_mm=float("inf")), "at most 10000 mm"),
        (Tool(1, diameter_mm=1e9), "at most 10000 mm"),
        (Tool(1, remark="x" * 41), "at most 40 letters"),
        (Tool(1, remark="two\nlines"), "on one line"),
    ],
)
def test_what_is_no_tool_is_refused(tool: Tool, sentence: str) -> None:
    made, keeper = plant(), Keeper()
    with pytest.raises(UsageError, match=sentence):
        store_tool(made.controller, tool, keeper.write)
    assert keeper.written == []
    assert tool_table(made.controller) == []
    made.close()


def test_a_tool_that_is_not_there_cannot_be_cleared() -> None:
    made = plant()
    with pytest.raises(UsageError, match="no tool 7"):
        clear_tool(made.controller, 7, Keeper().write)
    made.close()


def test_while_a_program_runs_or_waits_its_tools_stay() -> None:
    made, keeper = plant(t1={}), Keeper()
    said: list[str] = []

    def try_it() -> None:
        if not said or (made.controller.question and len(said) < 2):
            try:
                store_tool(made.controller, Tool(1, 5.0), keeper.write)
            except StateError as error:
                said.append(str(error))
        made.controller.answer()

    made.controller.set_break_key(try_it)
    run_text(made.controller, "G1 X5 F600\nM0\nG1 X6")
    made.controller.run()
    assert len(said) == 2
    assert "A program waits" in said[1]
    assert keeper.written == []
    assert tool_table(made.controller) == [Tool(1)]
    made.close()


def run(made: Plant, text: str) -> None:
    run_text(made.controller, text)
    assert made.controller.run() is Status.OK, made.controller.state().message


def test_what_a_program_has_set_is_in_the_table_and_a_person_has_the_last_word() -> None:
    made, keeper = plant(t3={"length_mm": 10, "diameter_mm": 6, "remark": "drill"}), Keeper()
    controller = made.controller
    run(made, "M61 Q3\nG10 L1 P3 Z42 R4 X1")
    assert tool_table(controller) == [Tool(3, 42.0, 8.0, "drill")]
    assert set_by_programs(controller) == {3}
    assert controller.state().work.tool_diameter_mm == 8
    # Also if that is what the file says already.
    store_tool(controller, Tool(3, 10.0, 6.0, "drill"), keeper.write)
    assert keeper.written == []
    assert tool_table(controller) == [Tool(3, 10.0, 6.0, "drill")]
    assert controller.state().work.tool_diameter_mm == 6
    run(made, "G43 H3")
    assert controller.state().work.tool_length_mm == 10
    assert controller.state().work.tool_offset_mm[0] == 1, "what the table has no column for stays"
    made.close()


def test_a_tool_that_only_a_program_knows_can_be_changed_and_cleared() -> None:
    made, keeper = plant(), Keeper()
    run(made, "G10 L1 P9 Z5")
    assert tool_table(made.controller) == [Tool(9, 5.0)]
    clear_tool(made.controller, 9, keeper.write)
    assert (tool_table(made.controller), keeper.written) == ([], [])
    with pytest.raises(UsageError, match="no tool 9"):
        clear_tool(made.controller, 9, keeper.write)
    made.close()


def test_it_is_the_same_table_after_a_restart(tmp_path: Path) -> None:
    config = Config.model_validate({"tools": {"3": {"length_mm": 10}}})
    made = assemble(config, state=tmp_path)
    run(made, "G10 L1 P3 Z42")
    made.controller.idle(2.0)
    made.close()
    again = assemble(config, state=tmp_path)
    assert tool_table(again.controller) == [Tool(3, 42.0)]
    store_tool(again.controller, Tool(3, 10.0), Keeper().write)
    again.controller.idle(2.0)
    again.close()
    last = assemble(config, state=tmp_path)
    assert tool_table(last.controller) == [Tool(3, 10.0)]
    last.close()
