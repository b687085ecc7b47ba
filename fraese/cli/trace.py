"""Waveforms in the terminal: a stretch drawn, its figures, and a picture of it."""

import fnmatch
import json
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer

from fraese.cli.leaving import leave
from fraese.cli.options import JsonOption
from fraese.cli.output import note, say, write
from fraese.errors import TraceError, UsageError
from fraese.phrases import phrase, reason
from fraese.plaintext import plain

if TYPE_CHECKING:
    from fraese.waves.stretch import Seen, Stretch
    from fraese.waves.vcdfile import VcdFile

app = typer.Typer()

_PLAIN_WIDTH: Final = 80
_SPAN: Final = "2ms"

FromOption = Annotated[
    str, typer.Option("--from", metavar="TIME", help="Begin here, as in 1.5s, 20ms, 300us.")
]
ToOption = Annotated[str, typer.Option("--to", metavar="TIME", help="End here.")]
AroundOption = Annotated[
    str,
    typer.Option(
        "--around",
        metavar="TIME|LINE[:N]",
        help="In the middle: a time, or the N-th edge of a line, by its name or a part of it.",
    ),
]
SpanOption = Annotated[
    str,
    typer.Option("--span", metavar="TIME", help=f"How much to show with --around; else {_SPAN}."),
]
LinesOption = Annotated[
    list[str] | None,
    typer.Option("--line", metavar="NAME", help="Only lines with this in their names; repeatable."),
]
PairOption = Annotated[
    list[str] | None,
    typer.Option(
        "--pair",
        metavar="DIR:CLOCK",
        help="Measure set-up between these lines; by default, those whose names tell. Repeatable.",
    ),
]
SvgOption = Annotated[
    Path | None, typer.Option("--svg", metavar="FILE", help="Also draw the stretch into this file.")
]


@app.command()
def trace(
    file: Annotated[Path, typer.Argument(metavar="FILE.vcd", help="Waveform of any program.")],
    start: FromOption = "",
    end: ToOption = "",
    around: AroundOption = "",
    span: SpanOption = "",
    lines: LinesOption = None,
    pairs: PairOption = None,
    svg: SvgOption = None,
    as_json: JsonOption = False,
) -> None:
    """Look at a waveform: draw a stretch, and print figures of every line."""

    def go() -> int:
        # Numbers take a tenth of a second to import; other commands do not pay for it.
        from fraese.waves.stretch import Stretch
        from fraese.waves.svg import WIDTH_PX
        from fraese.waves.vcdfile import VcdFile

        waveform = VcdFile(file)
        first, last = _ends(waveform, start, end, around, span)
        chosen, width = _chosen(waveform, lines or []), _width()
        label = _label(waveform, chosen, width)
        named = [_pair(words) for words in pairs or []]
        if svg is not None:
            wide = Stretch(waveform, first, last, WIDTH_PX, named)
            _write_svg(svg, wide, _drawn([wide.seen[number] for number in chosen], lines))
        stretch = Stretch(waveform, first, last, max(1, width - label - 1), named)
        shown = [stretch.seen[number] for number in chosen]
        if as_json:
            say(json.dumps(_as_dict(stretch, shown)))
        else:
            _show(stretch, shown, _drawn(shown, lines), label, width)
        return 0

    leave(go, as_json)


# --- which stretch -------------------------------------------------------------------------------


def _ends(file: "VcdFile", start: str, end: str, around: str, span: str) -> tuple[int, int]:
    """First and last moment, in units of the file.

    Raises:
        UsageError: if there is no such stretch.
    """
    if around:
        if start or end:
            raise UsageError(phrase("Either --from and --to, or --around with --span."))
        length = _units(file, span or _SPAN, "--span")
        if not length:
            raise UsageError(
                phrase(
                    "--span {span} is nothing to look at; say a length, as in {span_2}.",
                    span=span,
                    span_2=_SPAN,
                )
            )
        middle = _middle(file, around)
        first, last = middle - length // 2, middle + length // 2
    else:
        if span:
            raise UsageError(phrase("--span goes with --around, which says where."))
        first = _moment(file, start, "--from") if start else file.begin
        last = _units(file, end, "--to") if end else file.end
        if last <= first and (start or end):
            raise UsageError(phrase("--to must come after --from; nothing lies between them."))
    return max(0, first), max(last, first + 1, 1)


def _units(file: "VcdFile", text: str, option: str) -> int:
    """A time, in units of the file."""
    from fraese.waves import times

    return round(times.seconds(text, option) / file.unit_s)


def _moment(file: "VcdFile", text: str, option: str) -> int:
    """A time within the file, in its units.

    Raises:
        UsageError: if it is after the end.
    """
    from fraese.waves import times

    moment = _units(file, text, option)
    if moment > file.end:
        end = times.moment(file.end * file.unit_s)
        raise UsageError(
            phrase(
                "{option} {text} is after the end of {path}, {end}.",
                option=option,
                text=text,
                path=file.path,
                end=end,
            )
        )
    return moment


def _middle(file: "VcdFile", around: str) -> int:
    """A time, or an edge of a line."""
    from fraese.waves.stretch import number_of

    if around[:1].isdigit() or around[:1] == ".":
        return _moment(file, around, "--around")
    name, colon, words = around.rpartition(":")
    name, words = (name, words) if colon and words.isdigit() else (around, "1")
    number, wanted = number_of(file, name), int(words)
    if not wanted:
        raise UsageError(
            phrase("{name}:0: edges are counted from 1.", name=file.lines[number].name)
        )
    left = wanted
    for piece in file.pieces(file.begin, file.end, file.levels(file.begin)):
        at = piece[number].at if number in piece else ()
        if len(at) >= left:
            return int(at[left - 1])
        left -= len(at)
    raise UsageError(
        phrase(
            "{name} has {wanted} edges, not {wanted_2}.",
            name=file.lines[number].name,
            wanted=wanted - left,
            wanted_2=wanted,
        )
    )


def _chosen(file: "VcdFile", wanted: list[str]) -> list[int]:
    """Numbers of the lines that are wanted.

    Raises:
        UsageError: if one of the names fits none.
    """
    from fraese.waves.stretch import number_of

    if not wanted:
        return list(range(len(file.lines)))
    found: dict[int, None] = {}
    for word in wanted:
        pattern = f"*{word.lower()}*"
        fits = [n for n, x in enumerate(file.lines) if fnmatch.fnmatch(x.name.lower(), pattern)]
        found |= dict.fromkeys(fits or [number_of(file, word)])
    return list(found)


def _pair(words: str) -> tuple[str, str]:
    direction, colon, clock = words.partition(":")
    if not (direction and colon and clock):
        raise UsageError(
            phrase('--pair "{words}": two lines, as in --pair x_dir:x_step.', words=words)
        )
    return direction, clock


# --- shown ---------------------------------------------------------------------------------------


def _width() -> int:
    if not sys.stdout.isatty():
        return _PLAIN_WIDTH
    return shutil.get_terminal_size((_PLAIN_WIDTH, 24)).columns


def _label(file: "VcdFile", chosen: list[int], width: int) -> int:
    from fraese.waves.drawing import label_width

    return label_width([file.lines[number].name for number in chosen], width)


def _drawn(shown: "list[Seen]", wanted: list[str] | None) -> "list[Seen]":
    """Lines that were asked for; else those that change."""
    return shown if wanted else [seen for seen in shown if not seen.is_still]


def _show(
    stretch: "Stretch", shown: "list[Seen]", drawn: "list[Seen]", label: int, width: int
) -> None:
    from fraese.waves import drawing, times

    glyphs = drawing.FINE if _can_print("".join(drawing.FINE)) else drawing.PLAIN
    unit_s = stretch.file.unit_s
    for line in drawing.tables(stretch, drawn, label, width):
        say(line)
    for line in drawing.set_ups(stretch, drawn, label, width):
        say(line)
    for line in drawing.still(stretch, [seen for seen in shown if seen not in drawn]):
        write(_styled(line, dim=True) + "\n")
    # The picture comes last: it is what stays on a small screen.
    say(
        phrase(
            "\n{path}: {moment} to {moment_2}; a column is {length}",
            path=stretch.file.path,
            moment=times.moment(stretch.start * unit_s),
            moment_2=times.moment(stretch.end * unit_s),
            length=times.length(stretch.span_s / stretch.width),
        )
    )
    for seen in drawn:
        name, wave = drawing.row(seen, glyphs, label)
        write(f"{_styled(name, bold=True)} {_styled(wave, fg='green')}\n")
    for line in drawing.axis(stretch):
        write(_styled(f"{'':{label}} {line}", dim=True) + "\n")
    if sys.stdout.isatty() and drawing.is_dense(drawn):
        closer = phrase(
            "{many}: more edges than can be seen. Closer: --around TIME --span {span}",
            many=glyphs.many,
            span=_SPAN,
        )
        write(_styled(closer, dim=True) + "\n")


def _styled(text: str, **style: Any) -> str:
    return typer.style(plain(text), **style) if sys.stdout.isatty() else plain(text)


def _can_print(text: str) -> bool:
    try:
        text.encode(sys.stdout.encoding or "ascii")
    except UnicodeEncodeError:
        return False
    return True


def _write_svg(path: Path, stretch: "Stretch", shown: "list[Seen]") -> None:
    from fraese.waves.svg import picture

    try:
        if path.is_file() and path.read_bytes()[:1] not in (b"", b"<"):
            raise TraceError(
                phrase("{path} is there and is no picture; it is not overwritten.", path=path)
            )
        path.write_text(picture(stretch, shown), encoding="utf-8")
    except OSError as error:
        raise TraceError(
            phrase(
                "{path}: the picture cannot be written: {reason}.", path=path, reason=reason(error)
            )
        ) from error
    note(phrase("{path}: picture of the stretch.", path=path))


# --- for programs --------------------------------------------------------------------------------


def _as_dict(stretch: "Stretch", shown: "list[Seen]") -> dict[str, Any]:
    file = stretch.file
    return {
        "file": str(file.path),
        "from_s": file.seconds(stretch.start),
        "to_s": file.seconds(stretch.end),
        "lines": {seen.line.name: _line_as_dict(seen, file) for seen in shown},
        "set_ups": [
            {
                "direction": file.lines[s.direction].name,
                "clock": file.lines[s.clock].name,
                "count": s.shortest.count,
                "shortest_s": _scaled(s.shortest.length, file),
                "at_s": _scaled(s.shortest.at if s.shortest.count else None, file),
            }
            for s in stretch.set_ups
        ],
    }


def _line_as_dict(seen: "Seen", file: "VcdFile") -> dict[str, Any]:
    from fraese.waves.drawing import fastest_hz, mean_hz
    from fraese.waves.figures import QuantityFigures

    figures = seen.figures
    if isinstance(figures, QuantityFigures):
        return {
            "changes": figures.changes,
            "least": _known(figures.least),
            "most": _known(figures.most),
        }
    return {
        "level": _known(seen.columns.level),
        "edges": figures.edges,
        "rising": figures.rising,
        "rate_hz": mean_hz(figures, file.unit_s),
        "fastest_hz": fastest_hz(figures, file.unit_s),
        "duty": figures.duty,
        "shortest_high_s": _scaled(figures.high.length, file),
        "shortest_high_at_s": _scaled(figures.high.at if figures.high.count else None, file),
        "shortest_low_s": _scaled(figures.low.length, file),
        "shortest_low_at_s": _scaled(figures.low.at if figures.low.count else None, file),
        "first_edge_s": _scaled(figures.first_edge, file),
        "last_edge_s": _scaled(figures.last_edge, file),
    }


def _scaled(units: int | None, file: "VcdFile") -> float | None:
    return None if units is None else file.seconds(units)


def _known(value: float) -> float | None:
    return value if value == value else None
