"""The log: events with time and count, filtered and copied."""

from datetime import datetime, timedelta

from fraese.ui.eventlog import MOST_EVENTS, EventLog, Kind
from fraese.ui.views.log import LogView
from fraese.ui.widgets.events import EventList
from tests.ui.helpers import bench, play


def test_the_same_event_in_a_row_is_counted() -> None:
    times = iter(datetime(2026, 1, 1) + timedelta(seconds=n) for n in range(10_000))
    log = EventLog(lambda: next(times))
    for _ in range(12):
        log.add("No.", Kind.WARNING)
    log.add("Yes.")
    log.add("No.", Kind.WARNING)
    first, _, third = log.events
    assert (first.times, first.title) == (12, "No.  ×12")
    assert first.at == datetime(2026, 1, 1, 0, 0, 11)
    assert third.times == 1
    for n in range(MOST_EVENTS + 5):
        log.add(f"{n}")
    assert len(log.events) == MOST_EVENTS
    assert log.events[-1].title == f"{MOST_EVENTS + 4}"


def test_alarms_are_kept_with_number_and_advice_and_can_be_filtered_and_copied() -> None:
    async def scene() -> None:
        async with bench(notifications=True) as b:
            b.view.refuse("Not now.")
            b.view.refuse("Not now.")
            b.mill.mill.place(0, 300 * 200 - 100)
            await b.jog("right")
            assert len(b.app._notifications) == 1, "one notice at a time"
            await b.press("enter", "f6")
            view = b.app.view
            assert isinstance(view, LogView)
            await b.wait(lambda: view.is_mounted)
            await b.pilot.pause()
            shown = view.query_one(EventList)
            lines = shown.text().splitlines()
            assert "warning Not now.  ×2" in lines[0]
            alarm = next(line for line in lines if "Alarm 10: End switch xmax closed" in line)
            assert "reference the machine" in alarm
            await b.press("f")
            assert all("said" not in line for line in shown.text().splitlines())
            await b.press("f")
            assert shown.text().count("\n") == 0
            await b.press("c")
            assert b.app.clipboard == shown.text()
            assert view.said[0].startswith("1 event copied")

    play(scene)
