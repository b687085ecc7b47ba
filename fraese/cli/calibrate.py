"""Commands that measure the machine, and propose what its configuration should say."""

from collections.abc import Callable, Mapping, Sequence
from typing import Annotated, Any, Final, Literal

import typer

from fraese.axiswords import axes_named
from fraese.cli.histogram import histogram
from fraese.cli.options import VALUES, with_options
from fraese.cli.output import note
from fraese.cli.shared import Answering, Drive
from fraese.config.edit import as_toml, file_to_write, set_keys
from fraese.control.calibration.backlash import BacklashTest
from fraese.control.calibration.frequency import FrequencyTest
from fraese.control.calibration.proposal import Proposal
from fraese.control.calibration.repeat import Repeatability, RepeatTest
from fraese.control.calibration.stepsize import READING_MM, StepSizeTest
from fraese.control.calibration.sweep import Stage, Wish
from fraese.control.calibration.travel import TravelTest
from fraese.control.controller import Controller
from fraese.errors import UsageError
from fraese.phrases import phrase

_STAGES: Final[Mapping[str, Stage]] = {stage.name.lower(): stage for stage in Stage}
_BAR_CHARACTERS: Final = 30
#: The commands below.
NAMES: Final = ("travel", "steps", "backlash", "repeat", "frequency")

AxisArgument = Annotated[str, typer.Argument(metavar="AXIS", help="Its letter.")]
WriteOption = Annotated[
    bool, typer.Option("--write", help="Write what is found into the configuration file.")
]

app = typer.Typer(
    name="calibrate",
    help="Measure the machine, and propose what its configuration should say.",
    no_args_is_help=True,
)


class _Found:
    """What a command has to tell when the machine stands again.

    Args:
        on: the command's options.
        write: write what is proposed.
    """

    def __init__(self, on: Drive, write: bool) -> None:
        self._on = on
        self._write = write
        self.facts: Callable[[], Mapping[str, Any]] = dict
        self.proposal: Callable[[], Proposal | None] = lambda: None
        self.picture: Callable[[], Sequence[str]] = list
        self.after = ""

    def tell(self) -> dict[str, Any]:
        """For programs; for people it is noted. What is proposed is written, if that is wanted."""
        proposal = self.proposal()
        written = ""
        if not self._on.as_json:
            for line in self.picture():
                note(line)
        if proposal is not None:
            if not self._on.as_json:
                note(proposal.why)
                for change in proposal.changes:
                    note("  " + change.words())
            if self._write and proposal.changes:
                path = file_to_write(self._on.config)
                set_keys(path, proposal.values())
                written = str(path)
        now = self._what_now(proposal, written)
        if now and not self._on.as_json:
            note(now)
        changes = proposal.changes if proposal else ()
        return {
            "calibration": {
                **self.facts(),
                "proposed": {change.key: as_toml(change.new) for change in changes},
                "written": written or None,
            }
        }

    def _what_now(self, proposal: Proposal | None, written: str) -> str:
        if proposal is None:
            return self.after
        if not proposal.changes:
            return phrase("The configuration is right as it is.")
        if written:
            return phrase("Written to {written}; it counts from the next start.", written=written)
        return phrase("Nothing is written; --write does that.")


def _axis(controller: Controller, word: str) -> str:
    names = axes_named([word], controller.machine.names)
    if len(names) != 1:
        raise UsageError(phrase('"{word}": one axis, as in X.', word=word))
    return names[0]


@app.command()
@with_options
def travel(axis: AxisArgument, *, on: Drive, write: WriteOption = False) -> None:
    """Measure the travel of an axis, from one end switch to the other."""
    found = _Found(on, write)

    def action(controller: Controller) -> None:
        test = TravelTest(controller, _axis(controller, axis))
        found.proposal = test.proposal
        found.facts = lambda: test.result.as_dict() if test.result else {}
        test.start()

    on.do(action, more=found.tell)


@app.command(context_settings=VALUES)
@with_options
def steps(
    axis: AxisArgument,
    way: Annotated[float, typer.Argument(metavar="WAY", help="Signed, in mm; rotary: degrees.")],
    *,
    on: Answering,
    measured: Annotated[
        float | None,
        typer.Option(
            "--measured",
            metavar="MM",
            help="How far it went when WAY was made; negative: the other way. Nothing moves.",
        ),
    ] = None,
    reading: Annotated[
        float, typer.Option("--reading", metavar="MM", help="By how much that may be off.")
    ] = READING_MM,
    write: WriteOption = False,
) -> None:
    """Make a way; and with --measured, work out the steps per mm from how far it went."""
    found = _Found(on, write)

    def action(controller: Controller) -> None:
        name = _axis(controller, axis)
        test = StepSizeTest(controller, name)
        if measured is None:
            test.start(way)
            found.facts = lambda: {"commanded_mm": test.commanded_mm}
            found.after = phrase(
                "Measure how far it went, then: fraese calibrate steps {name} {way:g}"
                " --measured MM.",
                name=name.upper(),
                way=way,
            )
            return
        size = test.measured(way, measured)
        found.facts = size.as_dict
        found.proposal = lambda: test.proposals(reading)[0]

    on.do(action, more=found.tell)


@app.command()
@with_options
def backlash(
    axis: AxisArgument,
    *,
    on: Answering,
    gauge: Annotated[
        bool, typer.Option("--gauge", help="With a dial gauge: make its way and ask.")
    ] = False,
    read: Annotated[
        float | None,
        typer.Option("--read", metavar="MM", help="What the gauge showed then. Nothing moves."),
    ] = None,
    times: Annotated[
        int, typer.Option("--times", metavar="N", help="How often, by the end switch.")
    ] = 3,
    write: WriteOption = False,
) -> None:
    """Measure the backlash of an axis, by its end switch from both sides or by a dial gauge."""
    found = _Found(on, write)

    def action(controller: Controller) -> None:
        name = _axis(controller, axis)
        test = BacklashTest(controller, name)
        found.proposal = test.proposal
        found.facts = lambda: test.facts().as_dict()
        if read is not None:
            test.read(read)
        elif gauge:
            test.start_by_gauge()
            found.after = phrase(
                "Read the gauge, then: fraese calibrate backlash {name} --read MM.",
                name=name.upper(),
            )
        else:
            test.start_by_switch(times)

    on.do(action, more=found.tell)


@app.command()
@with_options
def repeat(
    axis: AxisArgument,
    *,
    on: Drive,
    end: Annotated[
        Literal["min", "max"] | None,
        typer.Option("--end", help="Which switch; else that to which the axis is referenced."),
    ] = None,
    times: Annotated[int, typer.Option("--times", metavar="N", help="How often.")] = 10,
) -> None:
    """Approach an end switch again and again: how well does it repeat?"""
    found = _Found(on, write=False)

    def action(controller: Controller) -> None:
        sign = None if end is None else 1 if end == "max" else -1
        test = RepeatTest(controller, _axis(controller, axis), sign, times)
        found.facts = lambda: test.facts().as_dict()
        found.picture = lambda: _picture(test.facts())
        test.start()

    on.do(action, more=found.tell)


def _picture(found: Repeatability) -> list[str]:
    """How often it closed where, about the mean."""
    bins = found.figures.bins(found.step_mm)
    edges = [round(each.low, 4) for each in bins] + [round(each.high, 4) for each in bins[-1:]]
    counts = [each.count for each in bins]
    return histogram(edges, [("times", counts)], found.unit, _BAR_CHARACTERS)


@app.command()
@with_options
def frequency(
    axis: AxisArgument,
    *,
    on: Drive,
    stage: Annotated[
        str | None,
        typer.Option("--stage", help="Only start, cruise or acceleration; else one by one."),
    ] = None,
    low: Annotated[
        float | None, typer.Option("--from", metavar="HZ", help="First value of the stage.")
    ] = None,
    high: Annotated[
        float | None, typer.Option("--to", metavar="HZ", help="Last value of the stage.")
    ] = None,
    step: Annotated[
        float | None, typer.Option("--step", metavar="HZ", help="From one value to the next.")
    ] = None,
    write: WriteOption = False,
) -> None:
    """Find out what rates and accelerations a motor follows; its end switch tells of lost steps.

    With a person's ears in place of the switch it is in the app.
    """
    found = _Found(on, write)

    def action(controller: Controller) -> None:
        test = FrequencyTest(controller, _axis(controller, axis), by_switch=True)
        found.facts = lambda: test.facts().as_dict()
        found.proposal = test.proposal
        wish = Wish(low, high, step)
        if stage is None and wish != Wish():
            raise UsageError(
                phrase("--from, --to and --step are of one stage: name it with --stage.")
            )
        if stage is not None and stage not in _STAGES:
            raise UsageError(
                phrase(
                    '"{stage}" is no stage: it is one of {stages}.',
                    stage=stage,
                    stages=", ".join(_STAGES),
                )
            )
        test.start([_STAGES[stage]] if stage else tuple(Stage), wish)

    on.do(action, more=found.tell)
