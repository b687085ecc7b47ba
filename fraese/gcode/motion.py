"""Motions: from words and modal state to canonical moves.

A method returns its moves and leaves the position behind them; where the outside has a word in
it, as after a probe, the position is set when its answer is known.
"""

from collections.abc import Callable, Iterable
from typing import Final, cast

from fraese.errors import ProgramError
from fraese.gcode import arcs
from fraese.gcode.axes import Axes, Way, plane_letters, third_letter
from fraese.gcode.canon import (
    Arc,
    Facts,
    Feed,
    Move,
    Probe,
    Rapid,
)
from fraese.gcode.drilling import Drilling
from fraese.gcode.modal import CYCLES, HOMES, Modal, name
from fraese.gcode.offsets import Coordinates
from fraese.gcode.parameters import Parameters
from fraese.gcode.position import Position
from fraese.gcode.words import Block
from fraese.phrases import phrase
from fraese.workframe import numbers

OFFSET_LETTERS: Final = {"x": "i", "y": "j", "z": "k"}
PROBE_RESULT: Final = 5061
PROBE_TOUCHED: Final = 5070
MAX_TURNS: Final = 100_000


class Motion(Position):
    """The motion codes."""

    def __init__(
        self,
        axes: Axes,
        parameters: Parameters,
        coordinates: Coordinates,
        modal: Modal,
        unreferenced: str,
    ) -> None:
        super().__init__(axes, coordinates, modal, unreferenced)
        self._parameters = parameters
        self._drilling = Drilling(self)

    def move(self, block: Block) -> Iterable[Move]:
        """The moves of the block's motion code.

        Raises:
            ProgramError: the motion is not possible as programmed.
        """
        code = block.motion
        if code is None:
            return ()
        if code in CYCLES:
            self.modal.motion = code
            return self._drilling.drill(block)
        self._drilling.forget()
        self.modal.motion = code
        nonmodal = block.codes.get("nonmodal")
        if nonmodal is not None:
            if nonmodal == 530:
                return self._machine_straight(block, code)
            if nonmodal in HOMES:
                return ()
        return _MOTIONS[code](self, block)

    def forget_cycle(self) -> None:
        """G80: the next canned cycle starts a series of its own."""
        self._drilling.forget()

    # Straight motion

    def _rapid(self, block: Block) -> Iterable[Move]:
        self.at = at = self.target(block)
        return (Rapid(self.line, self.coordinates.frame.to_machine(at)),)

    def _feed(self, block: Block) -> Iterable[Move]:
        to = self.target(block)
        modal = self.modal
        feed_mm_min = modal.feed_mm_min
        if modal.inverse_time or feed_mm_min <= 0 or not self.axes.only_linear:
            feed_mm_min = self.feed_for(block, self.axes.way(self.at, to), 10)
        self.at = to
        return (Feed(self.line, self.coordinates.frame.to_machine(to), feed_mm_min),)

    def _machine_straight(self, block: Block, code: int) -> Iterable[Move]:
        if code not in (0, 10):
            raise ProgramError(phrase("G53 needs G0 or G1"))
        if not self.modal.absolute:
            raise ProgramError(phrase("G53 needs G90: machine coordinates are absolute"))
        frame = self.coordinates.frame
        here = frame.to_machine(self.at)
        to = self.given(block, here)
        letters = [letter for letter in frame.axes if letter in block.words]
        self.require_reference(letters, 530)
        self.fix(letters)
        self.at = frame.to_work(to)
        if code == 0:
            return (Rapid(self.line, to, "z" in letters),)
        feed_mm_min = self.feed_for(block, self.axes.way(here, to), code)
        return (Feed(self.line, to, feed_mm_min, "z" in letters),)

    # Arcs

    def _arc(self, block: Block) -> Iterable[Move]:
        modal = self.modal
        code = cast(int, block.motion)
        first, second, third = self.axes.plane(modal.plane, name(code))
        self._check_arc_words(block.words)
        to = self.target(block)
        start, end = (self.at[first], self.at[second]), (to[first], to[second])
        turns = self._turns(block.words.get("p"), code)
        if not modal.inverse_time:
            self.feed_for(block, Way(0.0, False), code)
        centre = self._centre(block.words, start, end, turns > 0)
        rise_mm = 0.0 if third is None else to[third] - self.at[third]
        length_mm = arcs.length_mm(start, end, centre, turns, rise_mm)
        feed_mm_min = self.feed_for(block, Way(length_mm, False), code)
        middle = list(self.at)
        middle[first], middle[second] = centre
        machine = self.coordinates.frame.to_machine(tuple(middle))
        self.at = to
        return (
            Arc(
                self.line,
                self.coordinates.frame.to_machine(to),
                (machine[first], machine[second]),
                modal.plane,
                turns,
                feed_mm_min,
            ),
        )

    def _check_arc_words(self, words: dict[str, float]) -> None:
        ends = plane_letters(self.modal.plane)
        plane = f"G{self.modal.plane}"
        across = OFFSET_LETTERS[third_letter(self.modal.plane)]
        if across in words:
            raise ProgramError(
                phrase(
                    "{across} has no meaning in plane {plane}", across=across.upper(), plane=plane
                )
            )
        offsets = any(OFFSET_LETTERS[end] in words for end in ends)
        if "r" in words and offsets:
            raise ProgramError(phrase("an arc takes either R or a centre by I, J, K, not both"))
        if "r" not in words and not offsets:
            raise ProgramError(phrase("an arc needs R or a centre by I, J, K"))
        polar = "@" in words or "^" in words
        if "r" in words and not polar and ends[0] not in words and ends[1] not in words:
            both = " or ".join(letter.upper() for letter in ends)
            raise ProgramError(
                phrase(
                    "an arc with R needs its end: {both} in plane {plane}", both=both, plane=plane
                )
            )
        if self.coordinates.frame.is_rotated and self.modal.plane != 17:
            raise ProgramError(phrase("a rotated coordinate system allows arcs in plane G17 only"))

    def _turns(self, word: float | None, code: int) -> int:
        turns = 1 if word is None else round(word)
        if word is not None and (abs(word - turns) > 1e-4 or not 1 <= turns <= MAX_TURNS):
            raise ProgramError(phrase("the P word of an arc is a whole number of turns, 1 or more"))
        return turns if code == 30 else -turns

    def _centre(
        self, words: dict[str, float], start: arcs.Flat, end: arcs.Flat, left: bool
    ) -> arcs.Flat:
        scale = self.modal.scale_mm
        radius = words.get("r")
        if radius is not None:
            return arcs.centre_by_radius(start, end, radius * scale, left)
        first, second = plane_letters(self.modal.plane)
        letters = OFFSET_LETTERS[first], OFFSET_LETTERS[second]
        if self.modal.arc_absolute:
            for letter in letters:
                if letter not in words:
                    raise ProgramError(
                        phrase(
                            "G90.1 needs {letter} for the centre of an arc", letter=letter.upper()
                        )
                    )
            centre = words[letters[0]] * scale, words[letters[1]] * scale
        else:
            centre = (
                start[0] + words.get(letters[0], 0.0) * scale,
                start[1] + words.get(letters[1], 0.0) * scale,
            )
        arcs.check_centre(start, end, centre, scale)
        return centre

    # Probing

    def _probe(self, block: Block) -> Iterable[Move]:
        code = cast(int, block.motion)
        if not block.has_axes:
            raise ProgramError(phrase("{name} needs an axis word", name=name(code)))
        if self.modal.inverse_time:
            raise ProgramError(phrase("probing is not possible in G93; use G94"))
        to = self.target(block)
        feed_mm_min = self.feed_for(block, self.axes.way(self.at, to), code)
        towards, must = code in (382, 383), code in (382, 384)
        # Without a way to go a probe that must touch cannot; the others just do nothing.
        if must and self.at == to:
            raise ProgramError(
                phrase("{name} has no way to go: it starts at its target", name=name(code))
            )
        machine = self.coordinates.frame.to_machine(to)
        return (Probe(self.line, machine, feed_mm_min, towards, must),)

    def probed(self, probe: Probe, facts: Facts | None) -> None:
        """Take in how a probe move ended.

        Raises:
            ProgramError: the probe did not touch although it had to.
        """
        if facts is None:
            # As commanded: the way is gone to its end, and who must touch there does so.
            facts = Facts(probe.to, touched=probe.must_touch)
        contact = facts.position_mm if facts.contact_mm is None else facts.contact_mm
        values = self.coordinates.frame.to_work(contact)
        places = numbers(PROBE_RESULT, self.axes.letters)
        scales = self.axes.scales[self.modal.scale_mm]
        for place, value, unit in zip(places, values, scales, strict=True):
            self._parameters.set(place, value / unit)
        self._parameters.set(PROBE_TOUCHED, float(facts.touched))
        self.at = self.coordinates.frame.to_work(facts.position_mm)
        if probe.must_touch and not facts.touched:
            if probe.until_closed:
                raise ProgramError(phrase("the probe reached its target but did not touch"))
            raise ProgramError(phrase("the probe reached its target but did not open"))


_MOTIONS: Final[dict[int, Callable[[Motion, Block], Iterable[Move]]]] = {
    0: Motion._rapid,
    10: Motion._feed,
    20: Motion._arc,
    30: Motion._arc,
    **dict.fromkeys((382, 383, 384, 385), Motion._probe),
}
