"""The tool table, looked at and changed by hand.

Rule 1: there is one table: that of the configuration, with what programs have set since (G10
        L1). Who changes a line here has the last word: what a program had set of it is gone.
Rule 2: it changes between programs only. What runs was looked through with the table as it was;
        the next program finds the new one.
Rule 3: what cannot be written is not in force either.
"""

import math
from collections.abc import Callable, Mapping
from typing import Final, NamedTuple

from fraese.config.work import ToolConfig
from fraese.control.controller import Controller
from fraese.errors import StateError, UsageError
from fraese.log import logged
from fraese.phrases import phrase
from fraese.tooldata import ToolData, as_parameters, changed_tool, changed_tools, without_tool

#: No tool is longer or wider.
_MOST_MM: Final = 10_000.0
#: Longest remark, characters.
MOST_REMARK: Final = 40
#: Writes keys of the configuration file; None takes a key away.
Write = Callable[[Mapping[str, float | str | None]], object]


class Tool(NamedTuple):
    """A line of the table."""

    number: int
    length_mm: float = 0.0
    diameter_mm: float = 0.0
    remark: str = ""


def tool_table(controller: Controller) -> list[Tool]:
    """Its lines, by number, as the next program finds them."""
    configured, remarks = _configured(controller), _remarks(controller)
    kept = controller.position.offsets.parameters
    tools = {**configured, **changed_tools(kept, configured)}
    return sorted(
        Tool(number, tool.length_mm, tool.diameter_mm, remarks.get(number, ""))
        for number, tool in tools.items()
    )


def set_by_programs(controller: Controller) -> frozenset[int]:
    """Tools of which a program has the last word."""
    kept = controller.position.offsets.parameters
    return frozenset(changed_tools(kept, _configured(controller)))


def _configured(controller: Controller) -> dict[int, ToolData]:
    return {
        int(key): ToolData(tool.length_mm, tool.diameter_mm)
        for key, tool in controller.config.tools.items()
    }


def _remarks(controller: Controller) -> dict[int, str]:
    return {int(key): tool.remark for key, tool in controller.config.tools.items()}


@logged
def store_tool(controller: Controller, tool: Tool, write: Write) -> None:
    """Let a line of the table be this; at standstill.

    Args:
        controller: the machine.
        tool: the line, whole.
        write: keeps it.

    Raises:
        UsageError: if no tool is like that.
        StateError: while a program runs or waits; nothing is changed.
        ConfigError: from ``write``; nothing is changed.
    """
    if not 0 < tool.number < 10**9:
        raise UsageError(phrase("Tools are numbered from 1."))
    for value in (tool.length_mm, tool.diameter_mm):
        if not (math.isfinite(value) and abs(value) <= _MOST_MM):
            raise UsageError(
                phrase("Length and diameter of a tool are at most {most:g} mm.", most=_MOST_MM)
            )
    if tool.diameter_mm < 0:
        raise UsageError(phrase("The diameter of a tool is not negative."))
    if len(tool.remark) > MOST_REMARK or not tool.remark.isprintable():
        raise UsageError(
            phrase("A remark has at most {most} letters, on one line.", most=MOST_REMARK)
        )
    key = _key(controller, tool.number)
    values: dict[str, float | str] = {
        "length_mm": tool.length_mm,
        "diameter_mm": tool.diameter_mm,
        "remark": tool.remark,
    }
    before = controller.config.tools.get(key)
    changed: dict[str, float | str | None] = {
        f"tools.{key}.{name}": value
        for name, value in values.items()
        if before is None or getattr(before, name) != value
    }
    if before is None and not tool.remark:
        del changed[f"tools.{key}.remark"]
    if changed:
        write(changed)
    known = _set_by_program(controller, tool.number)
    _put(controller, {**controller.config.tools, key: ToolConfig.model_validate(values)})
    data = ToolData(tool.length_mm, tool.diameter_mm, known.others if known else {})
    _have_the_last_word(controller, tool.number, data)


@logged
def clear_tool(controller: Controller, number: int, write: Write) -> None:
    """Take a line out of the table; as ``store_tool``."""
    key, tools = _key(controller, number), dict(controller.config.tools)
    if key not in tools and _set_by_program(controller, number) is None:
        raise UsageError(phrase("There is no tool {number} in the table.", number=number))
    if key in tools:
        write({f"tools.{key}": None})
        del tools[key]
        _put(controller, tools)
    _have_the_last_word(controller, number, ToolData())


def _set_by_program(controller: Controller, number: int) -> ToolData | None:
    configured = _configured(controller).get(number, ToolData())
    return changed_tool(number, controller.position.offsets.parameters, configured)


def _have_the_last_word(controller: Controller, number: int, data: ToolData) -> None:
    """What a program had set is gone, but offsets of other axes that are nowhere else."""
    offsets = controller.position.offsets
    kept = without_tool(number, offsets.parameters)
    if any(data.others.values()):
        kept |= as_parameters(number, data, data)
    if kept != offsets.parameters:
        offsets.replace(kept)


def _key(controller: Controller, number: int) -> str:
    """Under which name the table has it, or would have it; at standstill."""
    if controller.question or controller.holding:
        raise StateError(
            phrase("A program waits: its tools stay as they are; nothing was changed.")
        )
    controller.require_ready()
    known = {int(key): key for key in controller.config.tools}
    return known.get(number, str(number))


def _put(controller: Controller, tools: Mapping[str, ToolConfig]) -> None:
    controller.config = controller.config.model_copy(update={"tools": dict(tools)})
