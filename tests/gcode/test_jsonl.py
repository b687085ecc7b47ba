import json

from fraese.gcode.jsonl import as_dict
from tests.gcode.run import moves


def test_every_kind_is_json() -> None:
    text = (
        "g0 x1|g1 y2 f100|g18 g3 i5 p2|g4 p1|g38.3 z-1|m3 s5|m8|t1 m6|m1|(msg,a)|g61|m49|m5|m9|m48"
    )
    dicts = [found for move in moves(text) if (found := as_dict(move)) is not None]
    kinds = [found["kind"] for found in dicts]
    assert kinds[:6] == ["rapid", "feed", "arc", "dwell", "probe", "spindle"]
    assert kinds[6:] == ["coolant", "spindle", "tool", "pause", "spindle", "coolant", "end"]
    assert json.loads(json.dumps(dicts)) == dicts
    assert dicts[0] == {"line": 1, "kind": "rapid", "to": [1, 0, 0]}
    assert dicts[2] == {
        "line": 3,
        "kind": "arc",
        "to": [1, 2, 0],
        "centre": [0, 6],
        "plane": 18,
        "turns": 2,
        "feed_mm_min": 100,
    }
