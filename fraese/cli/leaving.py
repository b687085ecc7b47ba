"""One way to leave: an exit code, and whatever is refused is one sentence, never a traceback."""

import contextlib
import json
import traceback
from collections.abc import Callable
from typing import Any

import typer

from fraese.alarms import AlarmKind, Trust
from fraese.cli.output import flush, note, result, settle
from fraese.errors import Alarm, Cancelled, FraeseError, OutputError
from fraese.log import write
from fraese.phrases import phrase


class AfterMotion(FraeseError):
    """What would have been a refusal, had the machine not moved before.

    Args:
        cause: what was raised.
    """

    def __init__(self, cause: FraeseError) -> None:
        super().__init__(str(cause))
        self.cause = cause


def alarm_result(error: FraeseError | None) -> dict[str, Any]:
    """What a JSON object says of an alarm."""
    return {"alarm": error.as_dict()} if isinstance(error, Alarm) else {}


def with_advice(kind: AlarmKind) -> str:
    """What to do after an alarm."""
    return phrase("Alarm {number}. {advice}", number=kind.number, advice=kind.advice())


def refuse(error: FraeseError, *, as_json: bool) -> int:
    """Say why nothing was done, or no more was done; the exit code."""
    words = {Cancelled: "cancelled", AfterMotion: "alarm"}
    cause = error.cause if isinstance(error, AfterMotion) else error
    if as_json:
        word = words.get(type(error), "refused")
        said = {"message": str(error), **cause.details()}
        result(json.dumps({"status": word, **said, **alarm_result(cause)}))
    sentence = str(error)
    note("fraese: " + (sentence if sentence.endswith("?") else sentence.rstrip(".") + "."))
    # Where nothing has moved, the sentence says what to do.
    if isinstance(cause, Alarm) and cause.kind.trust is not Trust.UNMOVED:
        note(with_advice(cause.kind))
    return error.exit_code


def leave(
    action: Callable[[], int],
    as_json: bool = False,
    cancelled: str = phrase("Cancelled before anything moved."),
) -> None:
    """Leave with an exit code; whatever is refused is one sentence.

    Args:
        action: what the command does.
        as_json: the sentence is a JSON object.
        cancelled: what is true if Ctrl-C ends it.
    """
    code = _carried_out(action, as_json, cancelled)
    with contextlib.suppress(KeyboardInterrupt):
        settle()
    raise typer.Exit(code)


def _carried_out(action: Callable[[], int], as_json: bool, cancelled: str) -> int:
    try:
        code = action()
        try:
            flush()
        except OutputError as error:
            return code or refuse(error, as_json=False)
        return code
    except FraeseError as error:
        return refuse(error, as_json=as_json)
    except (KeyboardInterrupt, typer.Abort):
        return refuse(Cancelled(cancelled), as_json=as_json)
    except BrokenPipeError:
        # Whoever read the output has seen enough; what was done was done.
        return 0
    except Exception as error:
        for line in traceback.format_exc().splitlines():
            write("cli", action.__qualname__, "error", line)
        note(
            phrase("fraese: stopped by an error in the program itself: {error}.", error=repr(error))
        )
        return 1
