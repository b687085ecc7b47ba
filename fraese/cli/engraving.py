"""What ``fraese engrave`` does: options to a job, a job to files, and how far it is."""

import contextlib
import json
import shutil
import sys
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Final

from fraese.cli.engraveoptions import Wanted
from fraese.cli.newfile import check_new, new_file
from fraese.cli.output import note, say, show_progress, wipe_progress, write
from fraese.dots import ASCII, BRAILLE, HALVES, Cell
from fraese.engrave import job as jobs
from fraese.engrave.job import Job, Tabs, check_number
from fraese.engrave.moves import Figures, Move
from fraese.engrave.preview import Preview
from fraese.engrave.program import described, lines, moves
from fraese.engrave.shapes import Path as Shape
from fraese.engrave.sketch import Sketch
from fraese.engrave.sources import read
from fraese.engrave.tools import Cutter, Laser, has_room
from fraese.engrave.ways import Plan, planned
from fraese.errors import UsageError
from fraese.phrases import phrase

_STANDARD: Final = "-"
_SILENT_S: Final = 1.0
_EVERY_S: Final = 0.1
_PLAIN_WIDTH: Final = 80
_PLAIN_HEIGHT: Final = 40
#: Options that count for one kind of tool only.
_OF_LASER: Final = ("power_min", "dynamic", "overscan")
_OF_CUTTER: Final = ("depth", "pass_depth", "safe_height", "plunge_feed", "spindle")
#: Options that count for some ways only.
_OF_WAYS: Final[Mapping[str, tuple[str, ...]]] = {
    "angle": (jobs.SWEEP,),
    "one_way": (jobs.SWEEP, jobs.BITMAP),
    "grey": (jobs.BITMAP,),
    "levels": (jobs.BITMAP,),
    "threshold": (jobs.OUTLINE, jobs.SWEEP),
    "tabs": (jobs.OUTLINE,),
    "tab_width": (jobs.OUTLINE,),
    "tab_height": (jobs.OUTLINE,),
}
_INCH_MM: Final = 25.4


def engraved(file: Path, wanted: Wanted) -> int:
    """Make the program; the exit code.

    Raises:
        UsageError: if an option or the file makes no sense.
        OutputError: if what is made cannot be written.
    """
    _check(wanted)
    _check_files(file, wanted)
    job, tool = _job(wanted), _tool(wanted)
    progress = _Progress(file.name)
    try:
        source = read(file)
        plan = planned(source, job, file.name, progress.stage)
        progress.count = plan.strokes.total
        result = _Result(file.name, plan, job, tool, wanted)
        result.make(progress)
    finally:
        progress.done()
    result.tell([*source.notes, *plan.notes, *_of_tabs(plan, job)])
    return 0


# --- what is wanted ----------------------------------------------------------------------------


def _check(wanted: Wanted) -> None:
    """See whether the options go together.

    Raises:
        UsageError: if they do not.
    """
    for option in jobs.BOUNDS:
        value = getattr(wanted, option.replace("-", "_"))
        if value is not None:
            check_number(option, value)
    given = {
        name: _is_given(getattr(wanted, name)) for name in (*_OF_LASER, *_OF_CUTTER, *_OF_WAYS)
    }
    for name, ways in _OF_WAYS.items():
        if given[name] and wanted.way not in ways:
            raise UsageError(
                phrase(
                    "{option} has no meaning with --way {way}; it is of {ways}.",
                    option=_option(name),
                    way=wanted.way,
                    ways=" / ".join(ways),
                )
            )
    for name in _OF_CUTTER:
        if given[name] and wanted.power is not None:
            raise UsageError(
                phrase("{option} is of a cutter, and --power of a laser.", option=_option(name))
            )
    for name in _OF_LASER:
        if given[name] and wanted.power is None:
            raise UsageError(
                phrase("{option} is of a laser, which has --power.", option=_option(name))
            )
    _check_pairs(wanted)


def _check_pairs(wanted: Wanted) -> None:
    if wanted.dpi is not None and wanted.distance is not None:
        raise UsageError(phrase("--dpi and --distance say the same; give one of them."))
    if wanted.levels is not None and wanted.grey != jobs.STEPS:
        raise UsageError(phrase("--levels goes with --grey steps."))
    if wanted.tabs is None and (wanted.tab_width or wanted.tab_height):
        raise UsageError(phrase("--tab-width and --tab-height go with --tabs."))
    if wanted.tab_height and wanted.power is not None:
        raise UsageError(phrase("--tab-height is of a cutter, and --power of a laser."))
    if wanted.power is not None and (wanted.power_min or 0) > wanted.power:
        raise UsageError(phrase("--power-min is above --power."))


def _is_given(value: object) -> bool:
    return value is not None and value is not False


def _option(name: str) -> str:
    return "--" + name.replace("_", "-")


def _check_files(file: Path, wanted: Wanted) -> None:
    """See whether there is something to make, and room for it.

    Raises:
        UsageError: if there is not.
    """
    if wanted.output is None and wanted.preview is None and not wanted.show:
        raise UsageError(phrase("Where to? -o FILE.ngc writes the program, --show draws it here."))
    if wanted.output == _STANDARD and (wanted.as_json or wanted.show):
        raise UsageError(phrase("-o - needs standard output for itself: no --json, no --show."))
    targets = [] if wanted.output in (None, _STANDARD) else [Path(str(wanted.output))]
    targets += [] if wanted.preview is None else [wanted.preview]
    for target in targets:
        check_new(target, force=wanted.force)
        if target.exists() and file.exists() and target.samefile(file):
            raise UsageError(phrase("{file} is what is read; it is not overwritten.", file=target))
    if len({target.resolve() for target in targets}) < len(targets):
        raise UsageError(phrase("{file} cannot be program and picture at once.", file=targets[0]))


def _job(wanted: Wanted) -> Job:
    fine = wanted.power is not None or wanted.way == jobs.OUTLINE
    distance = wanted.distance or (_INCH_MM / wanted.dpi if wanted.dpi else 0.1 if fine else 0.5)
    usual = Job()
    return Job(
        way=wanted.way,
        width_mm=wanted.width,
        height_mm=wanted.height,
        origin=wanted.origin,
        distance_mm=distance,
        angle_deg=wanted.angle or 0.0,
        both_ways=not wanted.one_way,
        threshold=_or(wanted.threshold, usual.threshold),
        inverted=wanted.invert,
        grey=wanted.grey or usual.grey,
        levels=wanted.levels or usual.levels,
        tolerance_mm=_or(wanted.tolerance, usual.tolerance_mm),
        tabs=Tabs(
            wanted.tabs or 0,
            _or(wanted.tab_width, usual.tabs.width_mm),
            _or(wanted.tab_height, usual.tabs.height_mm),
        ),
    )


def _tool(wanted: Wanted) -> Cutter | Laser:
    if wanted.power is not None:
        return Laser(
            power=wanted.power,
            power_min=wanted.power_min or 0.0,
            feed_mm_min=_or(wanted.feed, 1000.0),
            overscan_mm=_or(wanted.overscan, 2.0),
            dynamic=wanted.dynamic,
        )
    usual = Cutter()
    return Cutter(
        depth_mm=_or(wanted.depth, usual.depth_mm),
        pass_mm=_or(wanted.pass_depth, usual.pass_mm),
        safe_mm=_or(wanted.safe_height, usual.safe_mm),
        feed_mm_min=_or(wanted.feed, usual.feed_mm_min),
        plunge_mm_min=_or(wanted.plunge_feed, usual.plunge_mm_min),
        spindle_rev_min=_or(wanted.spindle, usual.spindle_rev_min),
    )


def _or(value: float | None, usual: float) -> float:
    return usual if value is None else value


def _of_tabs(plan: Plan, job: Job) -> list[str]:
    """What is to be said of tabs that find no room."""
    if not job.tabs.number or not isinstance(plan.strokes.each, list):
        return []
    rings = [s for s in plan.strokes.each if isinstance(s, Shape) and s.is_closed]
    short = sum(not has_room(ring, job.tabs) for ring in rings)
    if not short:
        return []
    return [
        phrase(
            "{short} of {count} closed outlines are too short for {tabs} tabs and have none.",
            short=short,
            count=len(rings),
            tabs=job.tabs.number,
        )
    ]


# --- what is made ------------------------------------------------------------------------------


class _Result:
    """The program, and what is drawn of it, in one pass over its moves."""

    def __init__(
        self, name: str, plan: Plan, job: Job, tool: Cutter | Laser, wanted: Wanted
    ) -> None:
        self._name, self._plan, self._job, self._tool, self._wanted = name, plan, job, tool, wanted
        self._figures = Figures()
        self._lines = 0
        self._preview = _preview(plan, job, tool) if wanted.preview else None
        self._sketch = _sketch(plan) if wanted.show else None

    def make(self, progress: "_Progress") -> None:
        """Write the files.

        Raises:
            OutputError: if they cannot be written.
        """
        each = self._lines_of(progress)
        out = self._wanted.output
        if out == _STANDARD:
            for line in each:
                write(line + "\n")
        elif out is None:
            for _ in each:
                pass
        else:
            with new_file(Path(out)) as file:
                for line in each:
                    file.write(f"{line}\n".encode("ascii"))
        if self._preview and self._wanted.preview:
            with new_file(self._wanted.preview) as file:
                self._preview.save(file)

    def _lines_of(self, progress: "_Progress") -> Iterator[str]:
        head = described(self._name, self._tool, self._job, self._plan.sheet)
        each = self._seen(moves(self._tool, self._plan.strokes, self._job, progress.strokes))
        for line in lines(head, self._tool, each):
            self._lines += 1
            yield line

    def _seen(self, each: Iterator[Move]) -> Iterator[Move]:
        takers = [self._figures, *(t for t in (self._preview, self._sketch) if t is not None)]
        for move in each:
            for taker in takers:
                taker.take(move)
            yield move

    def tell(self, notes: list[str]) -> None:
        """Say what became of it."""
        for text in notes:
            note(text)
        width, height = self._plan.sheet.size
        if self._wanted.as_json:
            say(json.dumps(self._as_dict(notes)))
            return
        for line in self._sketch.lines() if self._sketch else ():
            write(line + "\n")
        told = phrase(
            "{width:.3f} x {height:.3f} mm, {lines} lines, {cut_mm:.0f} mm cut,"
            " {rapid_mm:.0f} mm of rapids",
            width=width,
            height=height,
            lines=self._lines,
            cut_mm=self._figures.cut_mm,
            rapid_mm=self._figures.rapid_mm,
        )
        if self._wanted.output == _STANDARD:
            note(told)
            return
        where = self._wanted.output or self._name
        say(phrase("{file}: {told}", file=where, told=told))
        if self._wanted.preview:
            say(phrase("{file}: picture of the program.", file=self._wanted.preview))

    def _as_dict(self, notes: list[str]) -> dict[str, object]:
        preview = self._wanted.preview
        return {
            "status": "done",
            "file": self._wanted.output,
            "preview": None if preview is None else str(preview),
            "size_mm": [round(side, 3) for side in self._plan.sheet.size],
            "low_mm": [round(at, 3) for at in self._plan.sheet.low],
            "strokes": self._plan.strokes.total,
            "lines": self._lines,
            "cut_mm": round(self._figures.cut_mm, 3),
            "rapid_mm": round(self._figures.rapid_mm, 3),
            "notes": [str(text) for text in notes],
        }


def _preview(plan: Plan, job: Job, tool: Cutter | Laser) -> Preview:
    # The lines of a bitmap are as far apart as they are wide; those of a sweep are to be seen.
    line_mm = job.distance_mm if job.way == jobs.BITMAP else 0.0
    if isinstance(tool, Laser):
        overscan_mm = 0.0 if job.way == jobs.OUTLINE else tool.overscan_mm
        return Preview(plan.sheet, overscan_mm=overscan_mm, power=tool.power, line_mm=line_mm)
    return Preview(plan.sheet, depth_mm=tool.depth_mm, line_mm=line_mm)


def _sketch(plan: Plan) -> Sketch:
    columns, rows = _PLAIN_WIDTH, _PLAIN_HEIGHT
    if sys.stdout.isatty():
        columns, rows = shutil.get_terminal_size((_PLAIN_WIDTH, _PLAIN_HEIGHT))
    return Sketch(plan.sheet, max(10, columns - 1), max(5, rows - 3), _cell())


def _cell() -> Cell:
    """The finest dots that standard output has characters for."""
    for cell in (BRAILLE, HALVES):
        with contextlib.suppress(UnicodeEncodeError):
            cell.characters.encode(sys.stdout.encoding or "ascii")
            return cell
    return ASCII


class _Progress:
    """How far it is, on a terminal, of what takes long."""

    def __init__(self, name: str) -> None:
        self._name, self.count = name, 0
        self._began_s = self._told_s = time.monotonic()
        self._is_told = False
        self._is_shown = sys.stderr.isatty()

    def stage(self, what: str) -> None:
        """Something else is being done now."""
        if self._is_shown:
            self._show(phrase("{name}: {what} ...  Ctrl+C ends it", name=self._name, what=what))

    def strokes(self, done: int) -> None:
        """So many strokes are written."""
        if not self._is_shown or done % 64:
            return
        now_s = time.monotonic()
        if now_s - self._began_s < _SILENT_S or now_s - self._told_s < _EVERY_S:
            return
        self._told_s = now_s
        percent = 100 * done // max(1, self.count)
        self._show(
            phrase("{name}: {percent} % written  Ctrl+C ends it", name=self._name, percent=percent)
        )

    def _show(self, line: str) -> None:
        self._is_told = True
        show_progress(line)

    def done(self) -> None:
        """Nothing of it stays on the screen."""
        if self._is_told:
            wipe_progress()
