"""C programs: compiled, run, and judged by the lines of the port, as a waveform file has them."""

import os
import pty
import re
import select
import shutil
import signal
import subprocess
import sys
import time
from collections import defaultdict
from pathlib import Path

import pytest

from fraese.x4step.server import CALLS
from tests.x4step.kittyterminal import RELEASE, Screen, encoded
from tests.x4step.test_codes import CODES, FUNCTIONS, OTHERS

if shutil.which("gcc") is None:
    pytest.skip("there is no gcc", allow_module_level=True)

pytestmark = pytest.mark.alone

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "examples" / "x4step" / "c"
HEADERS = ROOT / "fraese" / "x4step" / "c"
EXAMPLES = sorted(path.stem for path in FOLDER.glob("*.c"))
CLOCK1, ACTIVE = "pin03_clock1", "pin17_active"


def compiled(folder: Path, source: Path) -> Path:
    """A program, with the flags that the command gives."""
    said = subprocess.run(
        [sys.executable, "-m", "fraese", "x4step", "--cflags", "--libs"],
        cwd=ROOT, capture_output=True, text=True, check=True,
    )  # fmt: skip
    target = folder / source.stem
    command = ["gcc", "-std=gnu89", "-w", str(source), *said.stdout.split(), "-o", str(target)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    return target


def example(folder: Path, number: int) -> Path:
    (name,) = (name for name in EXAMPLES if name.startswith(f"e{number:02d}_"))
    return compiled(folder, FOLDER / f"{name}.c")


def environment(folder: Path, clock: str) -> dict[str, str]:
    return {
        **os.environ,
        "FRAESE_X4STEP_CLOCK": clock,
        "FRAESE_TRACE": str(folder / "lines.vcd"),
        "XDG_CONFIG_HOME": str(folder / "none"),
        "PYTHONPATH": str(ROOT),
    }


class Trace:
    """What a waveform file says."""

    def __init__(self, folder: Path) -> None:
        text = (folder / "lines.vcd").read_text("ascii")
        names = dict(re.findall(r"\$var wire 1 (\S+) (\S+) \$end", text))
        self.changes: dict[str, list[tuple[int, str]]] = defaultdict(list)
        now_ns = 0
        for line in text.partition("$enddefinitions $end")[2].splitlines():
            if line.startswith("#"):
                now_ns = int(line[1:])
            elif line[:1] in "01" and line[1:] in names:
                self.changes[names[line[1:]]].append((now_ns, line[0]))

    def rises(self, name: str) -> list[int]:
        return [at for at, level in self.changes[name] if level == "1"]

    def falls(self, name: str) -> list[int]:
        return [at for at, level in self.changes[name] if level == "0"]

    def level(self, name: str) -> str:
        return self.changes[name][-1][1]

    @property
    def all_low(self) -> bool:
        lines = [name for name in self.changes if "input" not in name and "direction" not in name]
        return all(self.level(name) == "0" for name in lines)


@pytest.mark.parametrize(("name", "value"), [*CODES.items(), *OTHERS.items()])
def test_the_header_has_the_same_numbers(name: str, value: int) -> None:
    header = (HEADERS / "x4step.h").read_text("ascii")
    assert re.search(rf"^#define {name} {value}$", header, re.MULTILINE)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_the_header_has_the_functions(name: str) -> None:
    header = (HEADERS / "x4step.h").read_text("ascii")
    found = re.search(rf"^(int|long|void) {name}\((.*)\);$", header, re.MULTILINE)
    assert found
    words = [part.split()[-1].lstrip("*") for part in found[2].split(", ")]
    assert words == (FUNCTIONS[name] or ["void"])
    assert name in CALLS


#: Steps of axis 1 at the end, and motions.
ALONE = {1: (0, 0), 2: (2000, 2), 5: (2000, 2), 6: (1000, 1), 7: (300, 1), 8: (275, 1),
         15: (500, 1), 16: (1, 1)}  # fmt: skip


@pytest.mark.parametrize("number", ALONE)
def test_programs_that_end_by_themselves(tmp_path: Path, number: int) -> None:
    program = example(tmp_path, number)
    done = subprocess.run(
        [program], capture_output=True, text=True, timeout=60, check=False,
        env=environment(tmp_path, "virtual"), stdin=subprocess.DEVNULL,
    )  # fmt: skip
    assert done.stderr == ""
    trace = Trace(tmp_path)
    steps, motions = ALONE[number]
    assert len(trace.rises(CLOCK1)) == pytest.approx(steps, abs=15 if number in (7, 8, 15) else 1)
    # Example 16 ends before any time has passed.
    assert len(trace.rises(ACTIVE)) == motions or number == 16
    assert trace.all_low
    if number == 7:
        assert done.stdout == f"{len(trace.rises(CLOCK1))} steps\n"


def in_terminal(
    folder: Path, program: Path, keys: list[tuple[float, bytes]]
) -> tuple[int, str, Trace]:
    child, screen = pty.fork()
    if child == 0:
        os.execve(program, [str(program)], environment(folder, "paced"))
    trace = folder / "lines.vcd"
    until_s = time.monotonic() + 30
    while not trace.exists():
        assert time.monotonic() < until_s
        time.sleep(0.02)
    for pause_s, data in keys:
        time.sleep(pause_s)
        os.write(screen, data)
    seen = ""
    try:
        while select.select([screen], [], [], max(0.0, until_s - time.monotonic()))[0]:
            chunk = os.read(screen, 65536)
            if not chunk:
                break
            seen += chunk.decode()
    except OSError:
        pass
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    return code, seen.replace("\r\n", "\n"), Trace(folder)


@pytest.mark.parametrize("number", [3, 4, 9, 10, 12, 14, 17])
def test_escape_ends_it_and_other_keys_do_not(tmp_path: Path, number: int) -> None:
    program = example(tmp_path, number)
    _, seen, trace = in_terminal(tmp_path, program, [(0.4, b"abc\x1b[D"), (0.3, b"\x1b")])
    assert len(trace.rises(CLOCK1)) > 200
    assert trace.all_low
    assert "abc" not in seen
    assert ("ESC has braked" in seen) == (number == 14)
    if number == 17:
        assert len(trace.rises("pin01_signal1")) == 1


def test_enter_ends_it(tmp_path: Path) -> None:
    _, seen, trace = in_terminal(tmp_path, example(tmp_path, 14), [(0.4, b"\r")])
    assert "ENTER has braked" in seen
    assert trace.all_low


def test_one_way_and_the_other(tmp_path: Path) -> None:
    program = example(tmp_path, 11)
    _, _, trace = in_terminal(tmp_path, program, [(0.4, b"\x1b"), (1.0, b"\x1b")])
    assert len(trace.rises(ACTIVE)) == 2
    assert "0" in [level for _, level in trace.changes["pin02_direction1"][-2:]]


@pytest.mark.parametrize("key", [b"+", b"-"])
def test_a_key_that_is_held(tmp_path: Path, key: bytes) -> None:
    keys = [(0.4, key), (0.3, key), (0.03, key), (0.03, key)]
    _, _, trace = in_terminal(tmp_path, example(tmp_path, 13), keys)
    assert len(trace.rises(ACTIVE)) == 1
    assert len(trace.rises(CLOCK1)) > 50
    assert trace.all_low


_ENDLESS = '#include "x4step.h"\nmain() { X4Init(2); X4SetOut(1); X4MovePos(1, 1000, 200); %s }'


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_a_program_that_is_killed_leaves_all_off(tmp_path: Path, number: signal.Signals) -> None:
    source = tmp_path / "endless.c"
    source.write_text(_ENDLESS % "for (;;) X4GetState();", "ascii")
    program = compiled(tmp_path, source)
    running = subprocess.Popen(
        [program], env=environment(tmp_path, "paced"), stdin=subprocess.DEVNULL
    )
    until_s = time.monotonic() + 30
    while not (tmp_path / "lines.vcd").exists():
        assert time.monotonic() < until_s
        time.sleep(0.02)
    time.sleep(0.5)
    running.send_signal(number)
    running.wait(10)
    while True:
        time.sleep(0.2)
        trace = Trace(tmp_path)
        if trace.changes and trace.level("pin01_signal1") == "0":
            break
        assert time.monotonic() < until_s
    assert trace.all_low
    falls = trace.falls(CLOCK1)
    assert falls[-1] - falls[-2] > falls[len(falls) // 2] - falls[len(falls) // 2 - 1]


def test_a_program_that_forgets_the_end(tmp_path: Path) -> None:
    source = tmp_path / "forgetful.c"
    source.write_text(_ENDLESS % "delay(300); return 7;", "ascii")
    program = compiled(tmp_path, source)
    done = subprocess.run([program], env=environment(tmp_path, "virtual"), check=False)
    assert done.returncode == 7
    time.sleep(1.0)
    assert Trace(tmp_path).all_low


#: Calls, and what they answer.
ANSWERS = {
    "X4ReInit()": 9,
    "X4Load(1, 0, 0, 0, 1000, 50)": 9,
    "X4Start()": 11,
    "X4Brake()": 7,
    "X4Init(5)": 8,
    "X4Init(1)": 0,
    "X4BrakeCodes(many)": 8,
    'X4BrakeCodes("\\x1c\\x9c")': 0,
    "X4SetOut(5)": 8,
    "X4MovePos(0, 1000, 50)": 8,
    "X4Load(16777217L, 0, 0, 0, 1000, 50)": 13,
    "X4Load(0, 0, -16777216L, 0, 20000, 1000)": 0,
    "X4Load(2, 0, 0, 0, 1000, 50)": 12,
    "X4GetIn()": 31,
    "X4GetState()": 0,
    "X4LastBrakeCode()": 0,
    "kbhit()": 0,
    "getch()": -1,
    "inp(0x61)": 255,
    "X4ReInit() + 0": 0,
}


def test_answers_reach_the_program(tmp_path: Path) -> None:
    source = tmp_path / "answers.c"
    calls = "\n".join(f'    printf("%d\\n", (int)({call}));' for call in ANSWERS)
    source.write_text(
        "#include <stdio.h>\n#include <string.h>\n#include <conio.h>\n#include <dos.h>\n"
        '#include "x4step.h"\nchar many[30];\nmain()\n{\n    memset(many, 99, 21);\n'
        f"{calls}\n    return 0;\n}}\n",
        "ascii",
    )
    done = subprocess.run(
        [compiled(tmp_path, source)], env=environment(tmp_path, "virtual"),
        capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL,
    )  # fmt: skip
    assert [int(word) for word in done.stdout.split()] == list(ANSWERS.values())
    assert done.returncode == 0


_WATCHES = """
#include <dos.h>
#include <stdio.h>
#include "x4step.h"
main()
{
    char codes[2];
    int last = 0, now;
    X4Init(2);
    codes[0] = (char) 205; codes[1] = 0;
    X4BrakeCodes(codes);
    X4MovePos(1, 1000, 50);
    printf("moving\\n"); fflush(stdout);
    while (X4GetState())
        if ((now = inp(0x60)) != last) { printf("port %d\\n", last = now); fflush(stdout); }
    printf("braked by %d\\n", X4LastBrakeCode());
    X4ReInit();
}
"""


def test_port_60h_reads_releases_where_the_terminal_tells_them(tmp_path: Path) -> None:
    (tmp_path / "watches.c").write_text(_WATCHES, encoding="ascii")
    program = compiled(tmp_path, tmp_path / "watches.c")
    screen = Screen()
    screen.start_program([str(program)], environment(tmp_path, "paced"))
    screen.until("moving")
    screen.until_flags([31])
    screen.type(encoded("a", text="a"))
    screen.until("port 30\r\n")
    screen.type(encoded("a", RELEASE))
    screen.until("port 158\r\n")
    screen.type(encoded("RIGHT") + encoded("RIGHT", RELEASE))
    screen.until("braked by 205")
    screen.end()
    assert screen.terminal.flags == []
    assert Trace(tmp_path).all_low
