"""What a reference is worth after a program was killed in motion, and that it can be made again.

    home --> program killed --> last words  --> referenced as before, to the step --> home: the same
                            '-> words lost --> bounds, not referenced, not taken  --> home: the same

Truth is where the fake port's carriages are, from the switch that the reference run found.
"""

from pathlib import Path

import pytest

from fraese.assembly.survivors import KNOWN
from tests.rigs.lpt.fakeport import missing
from tests.rigs.lpt.shop import SHORT_MM, Answer, Shop, child_of, is_alive

pytestmark = pytest.mark.skipif(bool(missing()), reason=missing())

#: Within the travel, for a minute.
SHUTTLE = "G21 G90\n" + "G1 X4 Y4 F300\nG1 X1 Y1\n" * 40 + "M2\n"
MOVED_STEPS = 100


class Bench(Shop):
    """A machine that is referenced."""

    def __init__(self, folder: Path) -> None:
        super().__init__(folder, "ppdev", travel_mm=SHORT_MM)
        (self.folder / "shuttle.ngc").write_text(SHUTTLE)
        self.zero_steps = self.referenced_at(self.command("home", "--json"))

    def referenced_at(self, answer: Answer) -> tuple[int, ...]:
        """The carriages' place at machine zero, as a command that references says."""
        assert answer.code == 0, answer.noted
        assert set(answer.result["referenced"].values()) == {True}
        assert answer.result["doubt"] is None
        at = answer.result["position_steps"].values()
        return tuple(a - b for a, b in zip(self.fake.carriages_steps(), at, strict=True))

    def true_steps(self) -> tuple[int, ...]:
        """Where the machine is."""
        return tuple(
            a - b for a, b in zip(self.fake.carriages_steps(), self.zero_steps, strict=True)
        )

    def killed_in_motion(self) -> None:
        """SIGKILL to a program; its step process has ended, too."""
        begun = self.fake.carriages_steps()
        process = self.start("run", "shuttle.ngc")
        try:
            self.fake.wait_for(lambda: self.fake.carriages_steps()[0] - begun[0] > MOVED_STEPS)
            child = child_of(process.pid)
            process.kill()
            self.fake.wait_for(lambda: not is_alive(child))
        finally:
            process.kill()
            process.communicate()


def test_last_words_keep_the_reference_and_a_new_one_finds_the_same_place(tmp_path: Path) -> None:
    bench = Bench(tmp_path)
    bench.killed_in_motion()
    answer = bench.command("where", "--json")
    assert KNOWN in answer.noted
    assert bench.referenced_at(answer) == bench.zero_steps
    # It is known: there is nothing that a person would have to say.
    refused = bench.command("trust")
    assert (refused.code, "there is nothing to take" in refused.noted) == (2, True)
    # Who drives takes it over: limits count, and the way is the right one.
    answer = bench.command("move", "X2", "Y3", "--json")
    assert bench.referenced_at(answer) == bench.zero_steps
    assert bench.true_steps()[:2] == (400, 600)
    assert bench.command("move", f"X{SHORT_MM + 1}").code == 2
    assert bench.referenced_at(bench.command("home", "--json")) == bench.zero_steps


def test_without_them_nothing_is_trusted_until_it_is_referenced(tmp_path: Path) -> None:
    bench = Bench(tmp_path)
    bench.killed_in_motion()
    (words,) = (bench.folder / "user-state/fraese").glob("*.words")
    words.unlink()
    for _ in range(2):
        answer = bench.command("where", "--json")
        assert set(answer.result["referenced"].values()) == {False}
        doubt = answer.result["doubt"]
        bounds = zip(
            doubt["low_steps"].values(),
            bench.true_steps(),
            doubt["high_steps"].values(),
            strict=True,
        )
        assert all(low <= at <= high for low, at, high in bounds)
        refused = bench.command("trust")
        assert (refused.code, "it may be further" in refused.noted) == (2, True)
    assert bench.referenced_at(bench.command("home", "--json")) == bench.zero_steps
    assert bench.referenced_at(bench.command("where", "--json")) == bench.zero_steps
