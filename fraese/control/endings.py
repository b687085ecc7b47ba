"""Why the motors stopped, where no job says so."""

from fraese.control.endswitches import EndSwitches
from fraese.control.position import Position
from fraese.errors import FraeseError, KeepAlarm, SilenceAlarm, StopAlarm
from fraese.motor.seams import Ended, Report
from fraese.phrases import phrase


def alarm(report: Report, position: Position, switches: EndSwitches) -> FraeseError:
    """What is to be said, with the place where they stand."""
    ended, where = report.ended, position.in_words()
    if ended is Ended.SILENCE:
        return SilenceAlarm(
            phrase(
                "The program did not look after the motors for too long; they were braked"
                " and switched off at {where}.",
                where=where,
            )
        )
    if ended is Ended.STOP:
        return StopAlarm(
            phrase(
                "The motors stopped at {where}, and nobody here had asked for it: look at"
                " the line and at who else uses it.",
                where=where,
            )
        )
    return switches.alarm()


def not_kept(failure: FraeseError) -> KeepAlarm:
    """What is to be said where the disk does not take the place while the motors run."""
    return KeepAlarm(
        phrase(
            "Braked, because where the machine is could not be kept: {failure} It stands"
            " where is said, but a restart may not know that.",
            failure=failure,
        ),
        reason=str(failure),
    )
