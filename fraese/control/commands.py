"""What a machine can be told to do. Every command is refused or taken, in one sentence.

Rule 1: a refused command leaves everything as it was.
Rule 2: while a job asks the operator something, he may move by hand and set the zero of the axis
        that lifts the tool: a new tool is not as long as the one before. Nothing else.
"""

from abc import abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from typing import Final

from fraese.config import Config
from fraese.control import lines, softlimits
from fraese.control.about import BY_HAND, PLAIN, About
from fraese.control.endswitches import EndSwitches
from fraese.control.homing import Homing, chosen
from fraese.control.jobs import Job
from fraese.control.position import Position
from fraese.control.runloop import RunLoop
from fraese.errors import LimitError, StateError
from fraese.log import logged
from fraese.machine import Machine, Steps
from fraese.phrases import phrase

#: A rate is rounded to whole cycles.
_NEARLY: Final = 1.001
#: So far a tool is lifted where nobody knows the travel, mm.
_LIFT_MM: Final = 10.0


class Commands:
    """Commands of one machine; the attributes are the controller's."""

    machine: Machine
    config: Config
    position: Position
    switches: EndSwitches
    _loop: RunLoop

    @abstractmethod
    def start(self, name: str, job: Job, about: About = PLAIN) -> None:
        """Take up a job."""

    @abstractmethod
    def say(self, message: str) -> None:
        """Show a message."""

    @logged
    def jog(
        self,
        axis: str,
        distance_mm: float,
        *,
        clamp: bool = False,
        feed_mm_min: float | None = None,
    ) -> None:
        """One bounded move of one axis; ``run`` makes it.

        Args:
            axis: name.
            distance_mm: signed; not 0, at most ``jog.max_mm``.
            clamp: stop at the soft limit instead of refusing.
            feed_mm_min: None: as the configuration says (``jog.feed_mm_min``).

        Raises:
            LimitError: if it would leave the travel, or is too long or nothing.
            StateError: if the machine is not ready, or stands on the switch it would move into.
        """
        motor = self.machine.index(axis)
        moved, here = self.machine.axes[motor], self.position.position_steps[motor]
        softlimits.require_jog(moved, distance_mm, self.config.jog.max_mm)
        target = moved.to_steps(moved.to_mm(here) + distance_mm)
        self.jog_steps(axis, target - here, clamp=clamp, feed_mm_min=feed_mm_min)

    @logged
    def jog_steps(
        self,
        axis: str,
        distance_steps: int,
        *,
        clamp: bool = False,
        feed_mm_min: float | None = None,
    ) -> None:
        """The same in steps, with the same refusals."""
        softlimits.require_feed(feed_mm_min)
        self.require_ready()
        where, config, motor = self.position, self.config.jog, self.machine.index(axis)
        target = softlimits.jog_target(where, motor, distance_steps, config.max_mm, clamp=clamp)
        watch = self.switches.watch_for_jog(motor, distance_steps)
        here = where.position_steps
        line = lines.line_to(where, target, feed_mm_min or config.feed_mm_min, watch)
        self.start(phrase("jog {axis}", axis=axis.upper()), line, BY_HAND)
        self._tell_if_too_fast(here, target, feed_mm_min)

    @logged
    def move_to(
        self,
        targets_mm: Mapping[str, float],
        *,
        relative: bool = False,
        machine_coordinates: bool = False,
        feed_mm_min: float | None = None,
    ) -> None:
        """A straight line of one or several axes; ``run`` makes it.

        Args:
            targets_mm: by axis name, in work coordinates.
            relative: as distances from here instead.
            machine_coordinates: from machine zero instead.
            feed_mm_min: along the line; None: as fast as the axes can.

        Raises:
            LimitError: if the target is outside the travel.
            StateError: if the machine is not ready.
        """
        for name, value_mm in targets_mm.items():
            softlimits.require_finite(self.machine.axes[self.machine.index(name)], value_mm)
        softlimits.require_feed(feed_mm_min)
        target = self.position.to_steps(
            targets_mm, relative=relative, machine_coordinates=machine_coordinates
        )
        self.check_moves([target])
        here = self.position.position_steps
        self.start(phrase("move"), lines.line_to(self.position, target, feed_mm_min), BY_HAND)
        self._tell_if_too_fast(here, target, feed_mm_min)

    @logged
    def run_curve(
        self, points_mm: Sequence[Sequence[float]], feed_mm_min: float | None = None
    ) -> None:
        """Work through a list of points in work coordinates, straight lines in between.

        Raises:
            LimitError: if a point is outside the travel; nothing has moved then.
            StateError: if the machine is not ready.
        """
        frame = self.position.frame
        machine_mm = [frame.to_machine(tuple(point_mm)) for point_mm in points_mm]
        self.drive_points("curve", machine_mm, feed_mm_min)

    @logged
    def home(self, axes: Sequence[str] = (), *, measure: bool | None = None) -> None:
        """Reference axes; ``run`` does it.

        Args:
            axes: names; by default those with end switches, as configured.
            measure: run to the other end too.

        Raises:
            LimitError: if no axis has end switches and none was named.
            StateError: if the machine is not ready.
        """
        homing = self.config.homing
        order = chosen(self.config.home_order, axes, self.machine)
        measure = homing.measure if measure is None else measure
        lost = self._loop.lost_in_words
        job = Homing(homing, self.position, self.switches, self.say, lost, measure).job(order)
        axes = " ".join(name.upper() for name in order)
        self.start(phrase("reference {axes}", axes=axes), job)

    @logged
    def set_zero(self, axes: Iterable[str], value_mm: float = 0.0) -> None:
        """Let the present position have this work coordinate.

        Raises:
            StateError: while the machine runs; or a job waits, and it is not the axis of the tool.
        """
        axes = tuple(axes)
        if self._loop.is_open:
            self._require_vertical(axes)
        else:
            self._loop.require_not_running()
        self.position.set_zero(axes, value_mm)

    @logged
    def undo_zero(self) -> None:
        """Let the work zero be where it was before it was set last.

        Raises:
            StateError: if it was not, or something else has changed it since; or the machine runs.
        """
        self._loop.require_not_running()
        if not self.position.offsets.undo_zero():
            raise StateError(
                phrase("There is no work zero to undo: none was set since the last change.")
            )

    @logged
    def lift(self) -> None:
        """Raise the tool to the safe height; where nobody knows the travel, a little.

        Raises:
            LimitError: if it is there already.
            StateError: if the machine is not ready, or nothing lifts the tool.
        """
        vertical, jog_mm = self.machine.vertical, self.config.jog.max_mm
        if vertical is None:
            raise StateError(phrase("No axis of this machine lifts the tool."))
        axis, here = self.machine.axes[vertical], self.position.position_steps[vertical]
        if not self.position.referenced[vertical]:
            self.jog(axis.name, min(_LIFT_MM, jog_mm))
            return
        safe_mm = self.config.run.safe_z_mm
        top_mm = axis.high_mm if safe_mm is None else safe_mm
        if axis.to_steps(top_mm) <= here:
            raise LimitError(
                phrase(
                    "The tool is up already: {name} stands at its height.", name=axis.name.upper()
                )
            )
        self.move_to({axis.name: top_mm}, machine_coordinates=True)

    def _tell_if_too_fast(self, here: Steps, target: Steps, feed_mm_min: float | None) -> None:
        """What was asked for is more than the axes can: say what it goes with."""
        fastest = softlimits.fastest_mm_min(self.machine, here, target)
        if feed_mm_min is not None and feed_mm_min > fastest * _NEARLY:
            self.say(
                phrase(
                    "F {feed_mm_min:.0f} mm/min is more than the axes can: it goes with"
                    " {fastest:.0f}.",
                    feed_mm_min=feed_mm_min,
                    fastest=fastest,
                )
            )

    def _require_vertical(self, axes: Sequence[str]) -> None:
        vertical = self.machine.vertical
        lifts = self.machine.names[vertical] if vertical is not None else ""
        others = [name.upper() for name in axes if name != lifts]
        if others:
            only = (
                phrase("only the zero of {lifts} can be set", lifts=lifts.upper())
                if lifts
                else phrase("no zero can be set")
            )
            raise StateError(
                phrase(
                    "A program waits: {only} now, not that of {others}; nothing was changed.",
                    only=only,
                    others=", ".join(others),
                )
            )

    @logged
    def ignore_switches(self, ignore: bool) -> None:
        """Let contacts stop the motors, or not (for trying things out).

        Raises:
            StateError: while the machine runs.
        """
        self._loop.require_not_running()
        self.switches.ignore(ignore)

    def drive_points(
        self,
        name: str,
        points_mm: Sequence[Sequence[float]],
        feed_mm_min: float | None = None,
    ) -> None:
        """Straight lines through points in machine coordinates; ``run`` makes them.

        Raises:
            LimitError: if a point is outside the travel; nothing has moved then.
            StateError: if the machine is not ready.
        """
        targets = [softlimits.to_steps(self.machine, point_mm) for point_mm in points_mm]
        softlimits.require_feed(feed_mm_min)
        self.check_moves(targets)
        curve = lines.curve(self.position, targets, feed_mm_min)
        self.start(name, curve, About(lines=len(targets)))

    def check_moves(self, targets: Sequence[Steps]) -> None:
        """See that every target can be reached, before anything moves.

        Raises:
            LimitError: naming axis, target and travel.
            StateError: if the machine is not ready, or stands on a switch.
        """
        self.require_ready()
        self.switches.require_open()
        softlimits.require_reachable(self.position, targets)

    def require_ready(self) -> None:
        """See that a command may be given; then the inputs are known. As ``RunLoop`` has it."""
        self._loop.require_ready()
