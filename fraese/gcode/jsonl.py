"""Canonical moves as plain dictionaries, one a line of ``fraese gcode FILE``."""

from fraese.gcode.canon import (
    Arc,
    Breath,
    Command,
    Coolant,
    Dwell,
    End,
    Feed,
    Message,
    Move,
    Offsets,
    Output,
    Overrides,
    PathControl,
    Pause,
    Probe,
    Rapid,
    Spindle,
    Tool,
)

Json = dict[str, object]
_KINDS: dict[type, str] = {
    Rapid: "rapid",
    Feed: "feed",
    Arc: "arc",
    Dwell: "dwell",
    Probe: "probe",
    Spindle: "spindle",
    Coolant: "coolant",
    Output: "output",
    Command: "command",
    Tool: "tool",
    Pause: "pause",
    End: "end",
}
# What is said to the operator or to the planner, and moves nothing.
_SILENT = (Message, PathControl, Overrides, Offsets, Breath)
# Said elsewhere, or to a stage that is not asked here.
_HIDDEN = ("line", "is_place")


def as_dict(move: Move) -> Json | None:
    """A move as JSON-ready values, or None for what is no move (messages and modes).

    Keys: ``line`` and ``kind`` always; ``to`` in machine mm; for arcs ``centre`` in the order
    of the plane's axes (G17 x, y; G18 z, x; G19 y, z), ``plane`` (17, 18, 19) and signed
    ``turns``; ``feed_mm_min``; ``duration_s`` of a dwell; ``direction`` and ``rev_min`` of
    the spindle, and ``has_speed``; ``mist`` and ``flood``; ``name`` and ``is_on`` of an output;
    ``code`` and ``words`` of a command; ``number`` of a tool; ``optional`` of
    a pause, and of both the ``remark`` beside it;
    ``until_closed`` and ``must_touch`` of a probe.
    """
    if isinstance(move, _SILENT):
        return None
    result: Json = {"line": move.line, "kind": _KINDS[type(move)]}
    for key in move.__slots__:
        if key not in _HIDDEN:
            value = getattr(move, key)
            result[key] = list(value) if isinstance(value, tuple) else value
    return result
