"""One command on one machine without an app: progress, answers, result, exit code.

Rule 1: the last line on standard output is the result, for people or, with ``--json``, one object;
        everything else goes to standard error.
Rule 2: an interrupt or termination signal brakes with ramp, keeps the state, and ends with 130.
Rule 3: a question of the program is asked where a person sits at a terminal, who may move by hand
        before he answers (``byhand.py``). Elsewhere somebody has answered it beforehand
        (``answers.py``), or the job ends there.
"""

import json
import select
import shutil
import sys
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, Final

from fraese.assembly import Plant
from fraese.cli.answers import GO_ON, Answers
from fraese.cli.byhand import HINT, by_hand
from fraese.cli.departure import Departure
from fraese.cli.leaving import AfterMotion, alarm_result, with_advice
from fraese.cli.output import note, result, show_progress, wipe_progress
from fraese.control.controller import Controller
from fraese.control.position import Position
from fraese.control.state import MachineState, Status, three_decimals
from fraese.errors import Cancelled, FraeseError
from fraese.phrases import joined, phrase
from fraese.program.context import tool_table
from fraese.program.interrupted import cut_short
from fraese.signalwatch import watched
from fraese.tooldata import changed_tools
from fraese.workframe import G28_HOME, G30_HOME, stored

#: What else belongs to a result.
More = Callable[[], Mapping[str, Any]]

_STATUS_WORDS: Final = {Status.OK: "done", Status.CANCEL: "cancelled", Status.ERROR: "alarm"}
_EXIT_CODES: Final = {Status.OK: 0, Status.ERROR: 1, Status.CANCEL: Cancelled.exit_code}
#: A question that nobody answered.
_UNANSWERED: Final = "unanswered"
_SAID: Final = {
    "done": phrase("done"),
    "cancelled": phrase("cancelled"),
    "alarm": phrase("alarm"),
    _UNANSWERED: phrase("unanswered"),
}
_PROGRESS_EVERY_S: Final = 0.1
_LOOK_EVERY_S: Final = 0.05


class Session:
    """Runs commands on a plant and says how they ended.

    Args:
        plant: closed by ``finish``.
        as_json: result as one JSON object.
        departure: ends the process in time after a signal; None: nobody does.
        answers: to questions, given beforehand; None: none are.
    """

    def __init__(
        self,
        plant: Plant,
        *,
        as_json: bool,
        departure: Departure | None = None,
        answers: Answers | None = None,
    ) -> None:
        self._plant = plant
        self._controller = plant.controller
        self._as_json = as_json
        self._shows_progress = sys.stderr.isatty()
        self._shown_s = 0.0
        self._from_ns = plant.clock.now_ns()
        self._blocks = 0
        self._told = ""
        self._asked = self._unanswered = ""
        self._answers = answers or Answers()
        self._more: Mapping[str, Any] = {}
        self._may_raise = True
        self._hurries = threading.Event()
        self._departure = departure or Departure(leave=lambda code: None)
        self._controller.set_show_pos(self._progress)
        self._controller.set_break_key(self._answer)
        self._controller.set_tell(self._tell)
        for text in plant.notes:
            note(text)

    def do(self, command: Callable[[Controller], object], more: More = dict) -> int:
        """Command, run, result; the exit code.

        Args:
            command: what to do.
            more: asked when it went well, and the machine is closed: what else belongs to the
                result, for programs; for people it is noted there.

        Raises:
            FraeseError: if the command is refused; the machine has not moved.
        """
        with watched(self._interrupt, self._interrupt_main):
            try:
                status, state = self._carry_out(command)
                if status is Status.OK:
                    self._more = more()
            except FraeseError as error:
                if not any(self._controller.travelled_steps()):
                    raise
                raise AfterMotion(error) from error
            word, code = _STATUS_WORDS[status], _EXIT_CODES[status]
            if self._unanswered and not self._hurries.is_set():
                word, code = _UNANSWERED, 1
                state = replace(state, message=self._why_unanswered())
            self._departure.machine_is_closed(code)
            self._end_progress()
            if self._plant.trace is not None:
                note(self._plant.trace.waveform.sentence())
            self._say_result(word, state)
        return code

    def _carry_out(self, command: Callable[[Controller], object]) -> tuple[Status, MachineState]:
        """The job, to motors off and the state kept."""
        command(self._controller)
        if self._controller.status is Status.RUN:
            self._may_raise = False
        status = self._controller.run()
        self._may_raise = False
        state = self._controller.state()
        self._blocks = state.job.blocks if state.job else 0
        self._plant.close()
        return status, state

    def _interrupt(self, number: int = 0) -> None:
        """The job brakes; called in the thread that hears signals."""
        self._hurries.set()
        self._departure.hurry()
        if not self._may_raise and self._controller.status is Status.RUN:
            self._controller.cancel()

    def _interrupt_main(self, number: int) -> None:
        """Before anything moves the command is given up."""
        if self._may_raise:
            raise KeyboardInterrupt
        self._interrupt()

    def _why_unanswered(self) -> str:
        """Why the job has ended, where it stands, and how to go on."""
        stopped = phrase("Stopped at {place}.", place=self._controller.position.in_words())
        return joined(" ", [self._unanswered, stopped, *cut_short(self._controller.keep().job)])

    def _say_result(self, word: str, state: MachineState) -> None:
        if self._as_json:
            result(json.dumps(self._result(word, state)), self._hurries.is_set)
            return
        if state.message != self._told:
            note(state.message)
        if state.alarm is not None:
            note(with_advice(state.alarm))
        where = self._controller.machine.in_words(state.work_mm)
        in_force = state.work.words()
        sentence = joined(
            "", (_SAID[word], ": ", where, *((" (", in_force, ")") if in_force else ()))
        )
        result(sentence, self._hurries.is_set)

    def _result(self, word: str, state: MachineState) -> dict[str, Any]:
        def by_axis(values: tuple[Any, ...]) -> dict[str, Any]:
            return dict(zip(state.axes, values, strict=True))

        def if_seen(values: tuple[Any, ...]) -> dict[str, Any] | None:
            return by_axis(values) if values else None

        duration_ns = self._plant.clock.now_ns() - self._from_ns
        return {
            "status": word,
            "message": state.message,
            "position_mm": by_axis(state.position_mm),
            "position_steps": by_axis(state.position_steps),
            "work_mm": by_axis(state.work_mm),
            "work": {
                "system": state.work.system,
                "rotation_deg": state.work.rotation_deg,
                "g92": state.work.g92,
                "tool": state.work.tool,
                "tool_length_mm": state.work.tool_length_mm,
            },
            **self._kept_result(),
            "referenced": by_axis(state.referenced),
            "doubt": _doubt_result(self._controller.position),
            "steps": by_axis(self._controller.travelled_steps()),
            "units": by_axis(state.units),
            "step": state.step_word,
            "duration_s": round(duration_ns / 1e9, 6),
            "blocks": self._blocks,
            "late_ticks": state.late_ticks,
            "dry_queues": state.dry_queues,
            "carriages_mm": if_seen(state.carriages_mm),
            "lost_steps": if_seen(state.lost_steps),
            "lost_why": if_seen(state.lost_why),
            **alarm_result(self._controller.error),
            **self._trace_result(),
            **self._more,
        }

    def _kept_result(self) -> dict[str, Any]:
        """What else of the language outlives a program."""
        names, kept = self._controller.machine.names, self._controller.position.offsets.parameters
        homes = {"g28_mm": G28_HOME, "g30_mm": G30_HOME}
        places = {
            key: dict(zip(names, stored(kept, first, "".join(names)), strict=True))
            for key, first in homes.items()
        }
        tools = changed_tools(kept, tool_table(self._controller.config))
        return {
            **places,
            "tools_changed": {
                str(number): {"length_mm": tool.length_mm, "diameter_mm": tool.diameter_mm}
                for number, tool in tools.items()
            },
        }

    def _trace_result(self) -> dict[str, Any]:
        if self._plant.trace is None:
            return {}
        waveform = self._plant.trace.waveform
        return {
            "trace": {
                "file": str(waveform.path),
                "duration_s": waveform.duration_s,
                "changes": waveform.changes,
                "missing": waveform.missing,
                "failure": waveform.failure,
            }
        }

    # --- called by the run loop ----------------------------------------------------------------

    def _progress(self) -> None:
        now_s = time.monotonic()
        if not self._shows_progress or now_s - self._shown_s < _PROGRESS_EVERY_S:
            return
        self._shown_s = now_s
        state = self._controller.state()
        job = state.job
        where = " ".join(
            f"{name.upper()}{three_decimals(mm):>9}"
            for name, mm in zip(state.axes, state.work_mm, strict=True)
        )
        line = (
            phrase("line {line}/{lines}  ", line=job.line, lines=job.lines)
            if job and job.lines
            else ""
        )
        elapsed = f"{job.elapsed_s:8.1f} s" if job else ""
        # A line that wraps could not be wiped any more.
        width = shutil.get_terminal_size().columns - 1
        show_progress(f"{line}{where}  {elapsed}"[:width])

    def _end_progress(self) -> None:
        if self._shows_progress and self._shown_s:
            wipe_progress()

    def _tell(self, message: str) -> None:
        self._end_progress()
        self._told = message
        note(message)

    def _answer(self) -> None:
        """Ask once; then look for the answer between two rounds of the run loop.

        A program that waits in a read would be taken for hung by what drives the motors.
        """
        question = self._controller.question
        if not question:
            return
        if self._unanswered:
            return
        given = None if self._asked else self._answers.next()
        if given is not None:
            self._end_progress()
            note(joined("", (question, " [", given or GO_ON, "]")))
            self._do_as_told(given)
        elif sys.stdin.isatty():
            self._ask(question)
        else:
            self._unanswered = phrase(
                "{question} Nobody has answered: there is no terminal (--yes and --answer are for"
                " scripts).",
                question=question,
            )
            self._controller.cancel()

    def _ask(self, question: str) -> None:
        """Once; then look whether a line was typed."""
        if question != self._asked:
            self._asked = question
            self._end_progress()
            note(joined("", (question, " [", HINT, "] ")), end="")
        if not _line_waits():
            return
        self._asked = ""
        try:
            typed = input().strip()
        except EOFError:
            self._controller.cancel()
            return
        try:
            self._follow(typed)
        except FraeseError as error:
            note(str(error))

    def _do_as_told(self, given: str) -> None:
        """An answer given beforehand; one that is refused leaves the question unanswered."""
        try:
            self._follow(given)
        except FraeseError as error:
            self._unanswered = str(error)
            self._controller.cancel()

    def _follow(self, line: str) -> None:
        """Nothing: go on; else a word of moving by hand.

        Raises:
            FraeseError: it is refused.
        """
        if line:
            by_hand(self._controller, line)
        else:
            self._controller.answer()


def _line_waits() -> bool:
    """A line was typed; waits a moment for one. Where that cannot be seen: True."""
    try:
        return bool(select.select([sys.stdin], [], [], _LOOK_EVERY_S)[0])
    except (OSError, ValueError):
        return True


def _doubt_result(where: Position) -> dict[str, Any] | None:
    """Why the position may be another one, and between which places it is, if that is known."""
    doubt = where.doubt
    if doubt is None:
        return None
    low, high = zip(*where.bounds_steps(), strict=True) if doubt.spans_steps else (None, None)
    names = where.machine.names
    return {
        "why": doubt.why,
        "low_steps": low and dict(zip(names, low, strict=True)),
        "high_steps": high and dict(zip(names, high, strict=True)),
    }
