"""A simulated machine that is commanded, command by command; each is done when it returns.

    mill.home()  mill.move(x=10)  mill.run(...)     refused or stopped: raises what the machine says
    mill.at(1.5, lambda: mill.press("xmin"))        for the next of them

Rule 1: a command that comes back has been carried out to motors at rest.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Final, Self

from fraese.assembly import assemble
from fraese.control.state import Status
from fraese.errors import Cancelled, FraeseError
from fraese.program.program import Program, open_program
from fraese.program.telling import Stage
from fraese.program.typed import typed_program
from fraese.testing.failures import NoSuchName, TookTooLong
from fraese.testing.hands import Configuration, Hands, configured
from fraese.testing.patience import Patience
from fraese.testing.watch import Answers, Due, Watch

#: Machine time that a run may take, if nothing else is said.
LIMIT_S: Final = 3600.0


@dataclass(frozen=True)
class Run:
    """What came of a command.

    Attributes:
        duration_s: machine time that it took.
        lost_steps: by axis, asked for and not made, signed.
        said: sentences of the machine, in order.
        asked: questions of the program, in order.
        blocks: so many blocks were played.
    """

    duration_s: float
    lost_steps: dict[str, float]
    said: tuple[str, ...]
    asked: tuple[str, ...]
    blocks: int


class Mill(Hands):
    """A simulated machine in virtual time, that a test commands.

    Args:
        configuration: see ``hands.configured``.
        limit_s: machine time that a run may take.
        state: folder in which the state is kept, as between two starts of the program; None: it is
            not kept.

    Raises:
        ConfigError: one sentence with the key and what would be right.
    """

    def __init__(
        self,
        configuration: Configuration = None,
        *,
        limit_s: float = LIMIT_S,
        state: Path | None = None,
    ) -> None:
        super().__init__(assemble(configured(configuration), state=state))
        self.limit_s = limit_s
        self.controller = self._plant.controller
        self._said: list[str] = []
        self._watch = Watch(self.controller, self._plant.clock)
        self.controller.set_break_key(self._watch.between)
        self.controller.set_tell(self._said.append)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Motors off; the state is kept, where it is."""
        self._plant.close()

    # --- commands ------------------------------------------------------------------------------

    def home(self, *axes: str, measure: bool = False) -> Run:
        """Reference axes at their end switches, by default all.

        Args:
            axes: names.
            measure: run to the other end too.

        Raises:
            FraeseError: what the machine refuses, or stopped with.
        """
        self._require_axes(axes)
        return self._do("reference run", lambda: self.controller.home(axes, measure=measure))

    def move(
        self,
        *,
        feed: float | None = None,
        relative: bool = False,
        machine: bool = False,
        **targets_mm: float,
    ) -> Run:
        """A straight line, as in ``mill.move(x=10, y=5, feed=300)``.

        Args:
            feed: mm/min; None: as fast as the axes can.
            relative: distances from here.
            machine: machine coordinates, not those of the work.
            targets_mm: by axis.

        Raises:
            FraeseError: what the machine refuses, or stopped with.
        """
        self._require_axes(targets_mm)

        def command() -> None:
            self.controller.move_to(
                targets_mm, relative=relative, machine_coordinates=machine, feed_mm_min=feed
            )

        return self._do("move", command)

    def jog(self, axis: str, distance_mm: float, *, feed: float | None = None) -> Run:
        """One axis, a little way; as ``move``."""
        self._require_axes([axis])
        return self._do("jog", lambda: self.controller.jog(axis, distance_mm, feed_mm_min=feed))

    def zero(self, *axes: str, value_mm: float = 0.0) -> None:
        """Let the present position have this work coordinate; by default of all axes."""
        self._require_axes(axes)
        self.controller.set_zero(axes or self.axes, value_mm)

    def acknowledge(self) -> None:
        """Take note of an alarm: the next command may come."""
        self.controller.acknowledge()

    def check(self, program: Path | str) -> Program:
        """Look a program through; ``facts`` says what was found, how long it takes among it.

        Args:
            program: its file, or lines of G-code.

        Raises:
            ProgramError: a line is refused.
            LimitError: it leaves the travel.
            TookTooLong: it has no end.
        """
        taken = typed_program(program) if isinstance(program, str) else open_program(program)
        patience = Patience(f"looking through {taken.name}")

        def told(stage: Stage) -> None:
            patience.require()

        taken.told = told
        taken.check(self.controller)
        return taken

    def run(
        self,
        program: Path | str,
        *,
        answers: Answers = (),
        yes: bool = False,
        limit_s: float | None = None,
        from_line: int = 0,
    ) -> Run:
        """Look a program through, then run it to its end.

        Args:
            program: its file, or lines of G-code.
            answers: to its questions: what would be typed at each, "" to go on; one, several in
                turn, or who answers.
            yes: questions without an answer go on.
            limit_s: machine time that it may take; None: as the mill's.
            from_line: begin there; what lies before is only read.

        Raises:
            FraeseError: what is refused, or the machine stopped with.
            Unanswered: it asked, and nobody had an answer.
            TookTooLong: likewise.
            NeverCame: what was to be done meanwhile was not.
        """
        checked = self.check(program)
        facts, limit_s = checked.facts, self.limit_s if limit_s is None else limit_s
        if facts is not None and facts.duration_s > limit_s and not from_line:
            what = f"{checked.name}, which takes {facts.duration_s:.0f} s"
            raise TookTooLong(what, limit_s)

        def command() -> None:
            checked.start(self.controller, from_line=from_line)

        return self._do(checked.name, command, answers, yes=yes, limit_s=limit_s)

    # --- during the next of them ---------------------------------------------------------------

    def at(self, seconds: float, action: Callable[[], object]) -> None:
        """During the next run, do this when so much machine time has passed, to 0.1 s."""
        self._watch.plans.append(Due(f"{seconds:g} s", lambda now_s: now_s >= seconds, action))

    def when(
        self, condition: Callable[[], bool], action: Callable[[], object], moment: str = ""
    ) -> None:
        """During the next run, do this as soon as that holds; asked every 0.1 s.

        Args:
            condition: asked between two slices.
            action: done once.
            moment: what is waited for, for people.
        """
        words = moment or getattr(condition, "__name__", "its condition")
        self._watch.plans.append(Due(words, lambda now_s: condition(), action))

    def each(self, action: Callable[[], object]) -> None:
        """During the next run, do this between all slices, every 0.1 s of machine time."""
        self._watch.looks.append(action)

    def hold(self) -> None:
        """Brake and wait: for ``at`` and ``when``."""
        self.controller.hold()

    def resume(self) -> None:
        """Go on after a hold."""
        self.controller.resume()

    def cancel(self) -> None:
        """Brake, and drop the rest; the run raises ``Cancelled``."""
        self.controller.cancel()

    def stop(self) -> None:
        """Stop without ramp, and drop the rest; likewise."""
        self.controller.stop()

    def override(self, factor: float) -> None:
        """Feed override, 1 as programmed."""
        self.controller.handling.set_feed(factor)

    def _require_axes(self, names: Iterable[str]) -> None:
        for name in names:
            if name not in self.axes:
                raise NoSuchName(name, self.axes)

    def _do(
        self,
        what: str,
        command: Callable[[], object],
        answers: Answers = (),
        *,
        yes: bool = False,
        limit_s: float | None = None,
    ) -> Run:
        watch, before_s = self._watch, self.now_s
        self._said.clear()
        watch.begin(what, answers, yes=yes, limit_s=self.limit_s if limit_s is None else limit_s)
        command()
        status = self.controller.run()
        watch.end()
        if status is not Status.OK:
            raise self._failure(status)
        job = self.state.job
        return Run(
            duration_s=self.now_s - before_s,
            lost_steps=self.lost_steps,
            said=tuple(self._said),
            asked=tuple(watch.asked),
            blocks=job.blocks if job else 0,
        )

    def _failure(self, status: Status) -> FraeseError:
        if status is Status.ERROR and self.controller.error is not None:
            return self.controller.error
        return Cancelled(self.state.message)
