"""A monkey at the app: keys, mouse, pastes and sizes at random, and what must hold meanwhile.

    python -m tests.ui.monkey --events 100000        other ones every time
    python -m tests.ui.monkey --seed 7 --life 12     one life again

Rule 1: what a life consists of follows from seed and number of the life, whatever the app does;
        how fast the machine is beside it does not.
Rule 2: a life ends with the app (the monkey finds the way out) or after ``LIFE`` events.
Rule 3: the machine is looked at in the run loop's own turns, and all of it after every round, at
        rest: the stop key has to bring it there.
"""

import argparse
import asyncio
import os
import random
import sys
import tempfile
import time
from collections import deque
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Final

from textual import events
from textual.message import Message

from fraese.assembly import Plant, assemble
from fraese.cli.appsettings import AppSettings
from fraese.config.edit import FileWriter
from fraese.config.file import load
from fraese.control.state import Status
from fraese.motor.mill import Mill
from fraese.program.byhand import ByHand
from fraese.program.kept import KeptPrograms
from fraese.program.program import open_program
from fraese.program.recent import RecentPrograms
from fraese.program.resumption import Resumption
from fraese.ui import FraeseApp
from fraese.ui.messages import Refused
from tests.ui.monkeyhands import Hands

#: Events of one life of the app.
LIFE: Final = 2_000
#: What was done last, as many as a failure tells.
_TOLD: Final = 40
#: Jobs that look for an end switch.
_SEEKING: Final = ("measure the travel", "reference", "repeatability", "backlash")
#: A machine that is braked stands by then, however busy this computer is.
_REST_S: Final = 60.0
#: Small, so that it is at its ends often.
_MACHINE: Final = """
[axes.x]
travel_mm = 20
[axes.y]
travel_mm = 15
[axes.z]
travel_mm = 10
"""
_PROGRAM: Final = """G21 G90 G54
(MSG, a piece)
G0 X1 Y1
G1 X6 F400
G3 X6 Y5 I0 J2
M0
G1 X1 Y5
G4 P0.2
M6 T2
G0 X0 Y0
M2
"""


class Found(AssertionError):
    """Something that must not be."""


class Watch:
    """Looks at the machine after every slice of the run loop, and at rest.

    Args:
        plant: the machine.
        told: called with what the machine begins, and says.

    Attributes:
        found: the first thing that must not be; empty: nothing.
    """

    def __init__(self, plant: Plant, told: Callable[[str], object]) -> None:
        self._plant = plant
        self._told = told
        self._told_last = ""
        self._outside = self._outside_steps()
        self._blocked: set[int] = set()
        assert plant.bench is not None
        self._block = plant.bench.block
        plant.bench.block = self._hold  # type: ignore[method-assign]
        self.found = ""

    def _mill(self) -> Mill:
        assert self._plant.port is not None
        return self._plant.port.mill

    def _hold(self, axis: str, blocked: bool = True) -> None:
        """Somebody holds a carriage (the bench lets him): what it loses nobody can know."""
        self._blocked.add(self._plant.controller.machine.index(axis))
        self._block(axis, blocked)

    def _outside_steps(self) -> tuple[int | None, ...]:
        """By how much each axis is beyond its soft limits; None: nobody knows where it is."""
        where = self._plant.controller.position
        return tuple(
            max(axis.to_steps(axis.low_mm) - at, at - axis.to_steps(axis.high_mm), 0)
            if ok
            else None
            for axis, at, ok in zip(
                where.machine.axes, where.position_steps, where.referenced, strict=True
            )
        )

    def look(self) -> None:
        """No referenced axis gets further beyond its limits than it was."""
        now, job = self._outside_steps(), self._job()
        if job != self._told_last:
            self._told_last = job
            self._told(f"    machine: {job}")
        for axis, before, after in zip("xyz", self._outside, now, strict=True):
            if self._seeks_ends():
                continue
            if before is not None and after is not None and after > before:
                self.found = self.found or (
                    f"{axis} is {after} steps outside, {before} before, in {self._job()}"
                )
        self._outside = now

    def _seeks_ends(self) -> bool:
        """A job that has to run into the switches, which are outside."""
        return self._job().startswith(_SEEKING)

    def _job(self) -> str:
        state = self._plant.controller.state()
        return f"{state.job and state.job.name}: {state.message}"

    def hears(self, message: Message) -> None:
        """What the machine's thread refuses is a refusal, and no surprise."""
        if isinstance(message, Refused):
            self._told(f"    refused: {message.sentence}")
        if isinstance(message, Refused) and "by an error in the program" in str(message.sentence):
            self.found = self.found or str(message.sentence)

    def at_rest(self) -> None:
        """Counters and carriages agree where the position counts."""
        controller, onlooker = self._plant.controller, self._plant.onlooker
        assert onlooker is not None
        where, seen = controller.position, onlooker.look()
        for n, axis in enumerate(where.machine.axes):
            off_mm = abs(axis.to_mm(where.position_steps[n]) - seen.carriages_mm[n])
            if not where.referenced[n] and not self._mill().rotors[n].blocked:
                self._blocked.discard(n)
            if where.referenced[n] and n not in self._blocked and off_mm > 0.01 * axis.step_mm:
                self.found = self.found or (
                    f"{axis.name} counts {axis.to_mm(where.position_steps[n]):.4f} mm, and stands"
                    f" at {seen.carriages_mm[n]:.4f} mm; lost: {seen.lost_steps}"
                )


class Life:
    """One start of the app, and what the monkey does there.

    Args:
        seed: of the whole,
        number: and of this life.
        folder: for configuration, program and state.
        told: what is done and said is put down there.
    """

    def __init__(self, seed: int, number: int, folder: Path, told: deque[str]) -> None:
        self.chance = random.Random(f"{seed}/{number}")
        self.told = told
        self.told.clear()
        self._folder = folder
        path = folder / "fraese.toml"
        path.write_text(f'{_MACHINE}\n[log]\nfile = "{folder / "log"}"\n')
        (folder / "piece.nc").write_text(_PROGRAM)
        self._config = path
        self.plant = assemble(load(path))
        if self.chance.random() < 0.7:
            self.plant.controller.home()
            assert self.plant.controller.run() is Status.OK
        self.watch = Watch(self.plant, told.append)

    def _app(self) -> FraeseApp:
        kept, plant = KeptPrograms(self._folder), self.plant
        app = FraeseApp(
            plant.controller,
            open_program=partial(open_program, kept=kept),
            resume=partial(Resumption.of, kept=kept),
            recent=RecentPrograms(self._folder),
            program=self._folder / "piece.nc" if self.chance.random() < 0.7 else None,
            machine_name="simulated mill",
            hand=plant.press,
            bench=plant.bench,
            tools=ByHand(),
            writer=FileWriter(self._config),
            settings=AppSettings(self._config, plant.controller),
            history=self._folder / "typed",
            session=self._folder / "session.json",
        )
        link, post = app.link, app.link._post

        def show() -> None:
            self.watch.look()
            link.offer()

        def said(message: Message) -> None:
            self.watch.hears(message)
            post(message)

        plant.controller.set_show_pos(show)
        link._post = said
        return app

    async def live(self, most: int) -> int:
        """To its end; how many events it was.

        Raises:
            Found: something that must not be.
        """
        app, done = self._app(), 0
        async with app.run_test(size=(120, 40), notifications=True) as pilot:
            hands = Hands(app, self.chance)
            while done < most and app._running and not app._exit:
                for _ in range(self.chance.randrange(20, 80)):
                    what, pause_s = hands.do()
                    self.told.append(f"{done} {what}")
                    done += 1
                    # What comes at once is as good a test as what comes one by one.
                    if not done % 4:
                        await pilot._wait_for_screen()
                    if pause_s:
                        await asyncio.sleep(pause_s)
                    if app._exit or app._exception or done >= most:
                        break
                await self._rest(app)
        self._closed(app)
        return done

    async def _rest(self, app: FraeseApp) -> None:
        """The stop key brings the machine to a standstill."""
        until_s = time.monotonic() + _REST_S
        while not app._exit and (app.link.busy or app.link.moving):
            app._driver.process_message(events.Key("ctrl+c", "\x03"))  # type: ignore[union-attr]
            await asyncio.sleep(0.02)
            if app._exception:
                raise app._exception
            if time.monotonic() > until_s:
                raise Found("the stop key does not bring it to a standstill")
        if not app._exit:
            if not app.link._worker._thread.is_alive():
                raise Found("the machine's thread has ended")
            self.watch.look()
            self.watch.at_rest()
        if self.watch.found:
            raise Found(self.watch.found)

    def _closed(self, app: FraeseApp) -> None:
        """However it ended, the motors are off, and the code is that of an app that was left."""
        self.watch.at_rest()
        if self.watch.found:
            raise Found(self.watch.found)
        if app.exit_code:
            raise Found(f"it left with {app.exit_code}")
        assert self.plant.port is not None
        currents = self.plant.port.look().currents
        if any(any(each) for each in currents):
            raise Found(f"it left with motors on: {currents}")


def lives(seed: int, count: int, only: int | None = None) -> Iterator[tuple[int, int]]:
    """Let it live until it has done so much; number of each life, and events so far.

    Raises:
        Found: something that must not be; what was done last is in it.
    """
    number, done = only or 0, 0
    home, here = os.environ.get("HOME"), Path.cwd()
    while done < count:
        told: deque[str] = deque(maxlen=_TOLD)
        with tempfile.TemporaryDirectory() as folder:
            os.environ["HOME"] = folder
            os.chdir(folder)
            try:
                life = Life(seed, number, Path(folder), told)
                done += asyncio.run(life.live(min(LIFE, count - done)))
            except Exception as error:
                last = "\n    ".join(told)
                raise Found(
                    f"{type(error).__name__}: {error}\nafter\n    {last}\n"
                    f"again: python -m tests.ui.monkey --seed {seed} --life {number}"
                ) from error
            finally:
                os.chdir(here)
                if home is not None:
                    os.environ["HOME"] = home
        yield number, done
        if only is not None:
            return
        number += 1


def main() -> None:
    """As a command."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--events", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=random.randrange(1 << 32))
    parser.add_argument("--life", type=int)
    wanted = parser.parse_args()
    begun_s = time.monotonic()
    sys.stderr.write(f"seed {wanted.seed}\n")
    for number, done in lives(wanted.seed, wanted.events, wanted.life):
        sys.stderr.write(f"life {number}: {done} events, {time.monotonic() - begun_s:.0f} s\n")


if __name__ == "__main__":
    main()
