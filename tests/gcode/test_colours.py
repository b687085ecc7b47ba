"""The parts of a line, for whoever colours it."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.gcode.colours import Part, parts_of


@given(st.text(max_size=60))
def test_joined_the_parts_are_the_line(text: str) -> None:
    assert "".join(part for _, part in parts_of(text)) == text


@pytest.mark.parametrize(
    ("text", "kinds"),
    [
        ("N10 G1 X-1.5 F300", "flow code axis word"),
        ("g0x1y2(to)", "code axis axis comment"),
        ("M6 T2 ; tool", "switch word comment"),
        ("/ G0 Z5", "flow code axis"),
        ("%", "flow"),
        ("o100 if [#1 gt 3]", "flow value value value value value"),
        ("#<depth> = [2 * sin[30]]", "value value value value value value value value value value"),
        ("X[#3 + 1]", "axis value value value value value"),
        ("G1 & X1", "code wrong axis"),
        ("M98 P100", "flow word"),
    ],
)
def test_every_part_is_what_the_language_takes_it_for(text: str, kinds: str) -> None:
    found = [part.value for part, piece in parts_of(text) if piece.strip()]
    assert found == kinds.split()
    assert Part.PLAIN.value not in found
