"""A program looked through in a process of its own."""

import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from fraese.errors import Cancelled, LimitError, ProgramError
from fraese.program import looker
from fraese.program.context import ProgramContext
from fraese.program.program import open_program
from fraese.spawn import command, environment
from tests.helpers import homed, program

ENDLESS = "G21 G91 F600\no1 while [1]\nG1 X1\nG1 X-1\no1 endwhile\nM2\n"


def alive(pid: int) -> bool:
    """A process that still does something."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def gone_within(pid: int, patience_s: float) -> bool:
    until = time.monotonic() + patience_s
    while alive(pid):
        if time.monotonic() > until:
            return False
        time.sleep(0.01)
    return True


def test_it_finds_the_same_with_subroutine_files_and_again(tmp_path: Path) -> None:
    made = homed()
    (tmp_path / "hop.ngc").write_text("o<hop> sub\nG1 X5 F600\no<hop> endsub\n")
    text = "G21 G90\no<hop> call\no<here> call\nG1 Y2\nM2\no<here> sub\no<here> endsub\n"
    here, apart = program(tmp_path, text), open_program(tmp_path / "part.ngc", apart=True)
    assert apart.check(made.controller) == here.check(made.controller)
    assert set(apart.taken.files) == set(here.taken.files)
    (tmp_path / "hop.ngc").write_text("o<hop> sub\nG1 X100 F600\no<hop> endsub\n")
    assert apart.check(made.controller).high_mm == (5, 2, 0)
    assert apart.question(made.controller) is None
    apart.close()
    assert apart.check(made.controller).high_mm == (5, 2, 0)
    apart.close()


def test_it_counts_only_as_long_as_the_machine_stands_so(tmp_path: Path) -> None:
    made = homed()
    part = program(tmp_path, "G21 G90 G1 X250 F600\nM2\n")
    assert part.question(made.controller) is not None
    part.check(made.controller)
    assert part.question(made.controller) is None
    made.controller.jog("x", 1)
    made.controller.run()
    question = part.question(made.controller)
    assert question is not None
    part.look(question)
    assert part.question(made.controller) is None
    made.controller.move_to({"x": 100})
    made.controller.run()
    made.controller.set_zero("x")
    question = part.question(made.controller)
    assert question is not None
    with pytest.raises(LimitError, match="line 1"):
        part.look(question)
    assert part.question(made.controller) is not None


def test_modules_in_the_working_folder_are_not_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("dataclasses.py", "pickle.py", "sitecustomize.py", "fraese.py"):
        (tmp_path / name).write_text(f"open({str(tmp_path / 'run')!r}, 'w')\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", ["", str(tmp_path), *sys.path])
    part = open_program(program(tmp_path, "G0 X1\n").path, apart=True)
    part.check(homed().controller)
    part.close()
    assert not (tmp_path / "run").exists()


def given_up_after_s(folder: Path) -> float:
    """How long an endless program goes on being looked through when nobody wants that any more."""
    part = open_program(program(folder, ENDLESS).path, apart=True)
    controller = homed().controller
    question = part.question(controller)
    assert question is not None
    ended: list[tuple[float, Exception]] = []

    def look() -> None:
        try:
            part.look(question)
        except Exception as error:
            ended.append((time.monotonic(), error))

    thread = threading.Thread(target=look)
    thread.start()
    time.sleep(1.0)
    assert not ended
    before_s = time.monotonic()
    part.give_up()
    thread.join(10)
    [(at_s, error)] = ended
    assert isinstance(error, Cancelled)
    # What is given up before it has begun does not begin.
    with pytest.raises(Cancelled):
        part.look(question)
    assert part.question(controller) is not None
    return at_s - before_s


@pytest.mark.alone
def test_an_endless_program_is_given_up_at_once(tmp_path: Path) -> None:
    # A busy machine may take its time, but not every time.
    assert any(given_up_after_s(tmp_path) < 0.2 for _ in range(3))


def test_a_look_through_that_dies_is_said_and_the_next_one_works(tmp_path: Path) -> None:
    made = homed()
    part = open_program(program(tmp_path, "G0 X1\n").path, apart=True)
    part.check(made.controller)
    asking = part._looker
    assert asking is not None
    assert asking._process is not None
    asking._process.kill()
    asking._process.wait()
    with pytest.raises(ProgramError, match="ended unexpectedly"):
        part.check(made.controller)
    assert part.check(made.controller).ok
    part.close()


_HOST = """
import sys
from pathlib import Path
from fraese.assembly import assemble
from fraese.config import Config
from fraese.program.program import open_program
part = open_program(Path(sys.argv[1]), apart=True)
question = part.question(assemble(Config()).controller)
process = part._looker._started()
print(process.pid, flush=True)
part.look(question)
"""


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_it_does_not_outlive_who_asked(tmp_path: Path, number: int) -> None:
    path = program(tmp_path, ENDLESS).path
    words = [sys.executable, "-c", _HOST, str(path)]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as host:
        assert host.stdout is not None
        child = int(host.stdout.readline())
        assert alive(child)
        time.sleep(0.5)
        host.send_signal(number)
        host.wait(10)
        assert gone_within(child, 3)


def test_its_memory_is_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A loop holds every line that it passes."""
    monkeypatch.setattr(looker, "_MOST_MEMORY_BYTES", 128 << 20)
    line = "(" + "x" * 4000 + ")\n"
    path = tmp_path / "part.ngc"
    with path.open("w") as file:
        file.write("o1 while [1]\n")
        for _ in range(40):
            file.write(line * 1000)
    part = open_program(path, apart=True)
    with pytest.raises(ProgramError, match="more than 128 MB of memory"):
        part.check(homed().controller)
    part.close()


def test_it_says_nothing_to_a_terminal_and_ends_with_its_input() -> None:
    child = subprocess.run(
        command("fraese.program.lookthrough", "1000000000"),
        env=environment(),
        input=b"no question",
        capture_output=True,
        timeout=60,
        check=False,
    )
    assert child.stdout == b""


def test_a_context_says_how_the_machine_stands() -> None:
    made = homed()
    assert ProgramContext.of(made.controller) == ProgramContext.of(made.controller)
