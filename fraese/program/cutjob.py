"""A job with feeds and a spindle: what was read ahead does not count when it is cut short."""

from fraese.control.controller import Controller
from fraese.control.jobs import STANDSTILL, Job


def noting_cuts(controller: Controller, job: Job) -> Job:
    """The job to its standstill; if it is cut short, what was read ahead does not count.

    Outputs are off then; a spindle that is switched by hand turns on.
    """
    cutting = controller.cutting
    cutting.begin()
    try:
        yield from job
        yield STANDSTILL
    except BaseException:
        played = controller.move_played()
        cutting.end(played, is_off=not cutting.at(played).by_hand)
        raise
    cutting.end()
