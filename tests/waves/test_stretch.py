"""Figures and columns of any waveform, against a look at every edge, one after the other."""

import io
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from vcd import VCDWriter

from fraese.errors import TraceError
from fraese.waves import vcdfile
from fraese.waves.figures import LineFigures, QuantityFigures
from fraese.waves.stretch import Stretch, number_of, paired
from fraese.waves.vcdfile import VcdFile

HEADER = (
    "$timescale 1 us $end\n$scope module top $end\n"
    "$var wire 1 ! x_dir $end\n$var wire 1 # x_step $end\n$var wire 4 % nibble [3:0] $end\n"
    "$var real 64 & amps $end\n$upscope $end\n$enddefinitions $end\n"
)


def written(folder: Path, text: str) -> VcdFile:
    path = folder / "wave.vcd"
    path.write_text(text)
    return VcdFile(path)


def bits(stretch: Stretch, number: int) -> LineFigures:
    figures = stretch.seen[number].figures
    assert isinstance(figures, LineFigures)
    return figures


@given(
    st.lists(st.tuples(st.integers(1, 60), st.integers(0, 1)), min_size=1, max_size=60),
    st.integers(0, 600),
    st.integers(1, 900),
    st.integers(1, 40),
    st.integers(5, 400),
)
def test_a_line_is_what_one_sees_edge_by_edge(
    tmp_path_factory: pytest.TempPathFactory,
    steps: list[tuple[int, int]],
    start: int,
    span: int,
    width: int,
    piece_bytes: int,
) -> None:
    """Written by pyvcd, read in pieces of any size, over any stretch."""
    out = io.StringIO()
    with VCDWriter(out, timescale="1 ns") as writer:
        line = writer.register_var("top", "line", "wire", size=1, init=0)
        writer.register_var("top", "still", "wire", size=1, init=1)
        at, edges, level = 0, [], 0
        for gap, value in steps:
            at += gap
            writer.change(line, at, value)
            if value != level:
                edges.append((at, value))
                level = value
        writer.close(at + 5)
    path = tmp_path_factory.mktemp("waves") / "wave.vcd"
    path.write_text(out.getvalue())
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(vcdfile, "PIECE_BYTES", piece_bytes)
        file = VcdFile(path)
        assert file.end == at + 5
        stretch = Stretch(file, start, start + span, width)
    found = bits(stretch, 0)
    within = [(t, v) for t, v in edges if max(1, start) <= t <= start + span]
    before = [v for t, v in edges if t < start]
    assert stretch.seen[0].columns.level == (before[-1] if before else 0)
    assert found.edges == len(within)
    assert (found.first_edge, found.last_edge) == (
        (within[0][0], within[-1][0]) if within else (None, None)
    )
    pulses = [(b - a, v) for (a, v), (b, _) in pairwise(within)]
    assert found.high.length == min((n for n, v in pulses if v), default=None)
    assert found.low.length == min((n for n, v in pulses if not v), default=None)
    rises = [t for t, v in within if v]
    assert found.rising == len(rises)
    assert found.period.length == min((b - a for a, b in pairwise(rises)), default=None)
    if len(rises) > 1:
        high = sum(b - a for (a, v), (b, _) in pairwise(within) if v and a < rises[-1])
        assert found.duty == pytest.approx(high / (rises[-1] - rises[0]))
        assert found.rate == pytest.approx((len(rises) - 1) / (rises[-1] - rises[0]))
    columns = stretch.seen[0].columns
    assert columns.edges.sum() == len(within)
    assert columns.ends[-1] == (within[-1][1] if within else columns.level)
    assert stretch.seen[1].is_still
    assert stretch.seen[1].columns.ends.tolist() == [1] * width


@given(
    st.lists(st.tuples(st.integers(1, 50), st.sampled_from("dc")), min_size=1, max_size=80),
    st.booleans(),
)
def test_set_up_is_from_the_last_change_to_the_next_step(
    tmp_path_factory: pytest.TempPathFactory, events: list[tuple[int, str]], rests_high: bool
) -> None:
    text, at, levels = "#0\n0!\n" + f"{int(rests_high)}#\n", 0, {"d": 0, "c": int(rests_high)}
    waiting, expected = None, []
    for gap, what in events:
        at += gap
        levels[what] ^= 1
        text += f"#{at}\n{levels[what]}{'!' if what == 'd' else '#'}\n"
        if what == "d":
            waiting = at
        elif levels["c"] != rests_high and waiting is not None:
            expected.append(at - waiting)
            waiting = None
    file = written(tmp_path_factory.mktemp("waves"), HEADER + text)
    (set_up,) = Stretch(file, 0, file.end, 10).set_ups
    assert set_up.shortest.count == len(expected)
    assert set_up.shortest.length == min(expected, default=None)


def test_a_direction_that_changes_with_its_clock_has_no_set_up_at_all(tmp_path: Path) -> None:
    file = written(tmp_path, HEADER + "#0\n0!\n0#\n#10\n1#\n1!\n#20\n0#\n")
    assert Stretch(file, 0, 20, 10).set_ups[0].shortest.length == 0


def test_a_moment_and_its_changes_in_one_line_as_pulseview_writes_them(tmp_path: Path) -> None:
    file = written(tmp_path, HEADER + "#0 0! 1# b0101 % r1.5 &\n#100 1! bx0 %\n#250 0#\n#400\n")
    stretch = Stretch(file, 0, file.end, 8)
    assert file.unit_s == 1e-6
    assert file.end == 400
    assert [bits(stretch, n).first_edge for n in (0, 1)] == [100, 250]
    nibble, amps = (stretch.seen[n].figures for n in (2, 3))
    assert isinstance(nibble, QuantityFigures)
    assert isinstance(amps, QuantityFigures)
    assert (nibble.least, nibble.most, nibble.changes) == (5, 5, 1)
    assert np.isnan(nibble.level)
    assert (amps.least, amps.most) == (1.5, 1.5)


@pytest.mark.parametrize("cut", range(1, 9))
def test_a_file_that_was_cut_off_is_read_as_far_as_it_goes(tmp_path: Path, cut: int) -> None:
    whole = HEADER + "#0\n0!\n0#\n#100\n1!\n#250\n1#\n"
    file = written(tmp_path, whole[:-cut])
    stretch = Stretch(file, 0, file.end, 8)
    assert bits(stretch, 0).first_edge == 100
    assert bits(stretch, 1).edges == (1 if cut == 1 else 0)


def test_all_levels_again_and_comments_are_no_changes(tmp_path: Path) -> None:
    text = "#0\n0!\n1#\n#50\n$dumpall\n0!\n1#\n$end\n#60\n$comment 5 #7 1! $end\n#70\n1!\n"
    stretch = Stretch(written(tmp_path, HEADER + text), 0, 70, 8)
    assert [bits(stretch, n).edges for n in (0, 1)] == [1, 0]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "the file is empty"),
        ("G1 X1\n", "line 1: this is no VCD file"),
        ("$timescale 1 ns $end\n", "line 1: this is no VCD file"),
        ("$timescale 3 ns $end\n$enddefinitions $end\n", "line 1: $timescale 3 ns is none"),
        ("\n$var wire ! a $end\n$enddefinitions $end\n", "line 2: $var wire ! a is none"),
        ("$timescale 1 ns $end\n$enddefinitions $end\n#0\n", "the header names no line"),
        (HEADER + "0!\n", "nothing was recorded"),
        (HEADER + "#0\n0!\n#9\n1!\n#8\n0!\n#10\n", 'line 13: "#8" is before #9'),
        (HEADER + "#0\n0!\n1?\n#10\n", 'line 11: "1?" is no change'),
        (HEADER + "#0\n0!\n#1x\n#10\n", 'line 11: "#1x" is no moment'),
        (HEADER + "#0\nb12 %\n#10\n", 'line 10: "%" is no change'),
    ],
)
def test_what_is_wrong_is_told_with_its_line(tmp_path: Path, text: str, said: str) -> None:
    def look() -> Stretch:
        file = written(tmp_path, text)
        return Stretch(file, 0, file.end, 8)

    with pytest.raises(TraceError) as refused:
        look()
    assert said in str(refused.value)
    assert str(refused.value).count("\n") == 0


def test_lines_that_belong_together_by_their_names(tmp_path: Path) -> None:
    names = ["pin02_x_direction", "pin03_x_clock", "DIR_Y", "STEP_Y", "pin08_direction4", "dir"]
    wires = "".join(f"$var wire 1 {chr(40 + n)} {name} $end\n" for n, name in enumerate(names))
    file = written(tmp_path, f"$timescale 1 ns $end\n{wires}$enddefinitions $end\n#0\n0(\n")
    assert paired(file.lines) == [(0, 1), (2, 3)]
    assert number_of(file, "x_cl") == 1
    assert number_of(file, "dir") == 5


def test_names_that_come_twice_are_told_apart(tmp_path: Path) -> None:
    header = (
        "$scope module a $end\n$var wire 1 ! d $end\n$upscope $end\n"
        "$scope module b $end\n$var wire 1 # d $end\n$var wire 1 ! other $end\n$upscope $end\n"
    )
    file = written(tmp_path, f"{header}$enddefinitions $end\n#0\n0!\n0#\n")
    assert [line.name for line in file.lines] == ["a.d", "b.d"]


def test_a_stretch_far_inside_is_found_without_reading_all(tmp_path: Path) -> None:
    """And a line that changed last long before is known there."""
    text = "".join(f"#{n * 10}\n{n % 2}#\n" for n in range(200_000))
    path = tmp_path / "wave.vcd"
    path.write_text(HEADER + "#0\n1!\n" + text)
    file = VcdFile(path)
    levels = file.levels(1_500_000)
    assert levels[:2] == [1, 1]
    with path.open("rb") as opened:
        assert (
            0 < 1_500_000 / 2_000_000 - file._offset(opened, 1_500_000) / path.stat().st_size < 0.2
        )
    stretch = Stretch(file, 1_500_000, 1_500_100, 10)
    assert bits(stretch, 1).edges == 11
