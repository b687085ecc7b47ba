"""One boot of the guest: QEMU with an emulated parallel port, every access traced.

    host                                            guest
    results folder  <-------- 9p, writable ------>  the same path
    /               --------- 9p, read-only ----->  /
    trace.log       <-- QEMU -- isa-parallel at 0x378 <-- kernel <-- the job

The port ends in nothing, where the trace is the witness; or, for ``fake``, in the preloaded fake
port under QEMU, whose log is the witness and whose inputs the host drives.

Only emulation is used: hardware acceleration would be faster, but is not everywhere.
"""

import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import Final, NamedTuple

from rigs.lpt.kernel import ROOT, Kernel
from tests.rigs.lpt.fakeport import FakePort

TIMEOUT_S: Final = 180.0

#: This register of the block exists and touches no line: writes to it mark places in the trace.
MARK: Final = 3

_TRACED: Final = re.compile(
    r"^\d+@([\d.]+):parallel_ioport_(read|write) .* addr 0x(\w+) val 0x(\w+)$"
)


class Access(NamedTuple):
    """One access to the emulated port, as QEMU saw it."""

    at_s: float
    is_write: bool
    register: int
    value: int


class Machine:
    """A guest that runs one Python module and powers off.

    Args:
        kernel: what boots.
        results: a folder that is empty; the guest writes there.
        arguments: the module and its arguments.
        append: for the kernel's command line.
        fake: the fake port that the emulated one is wired to.
    """

    def __init__(
        self,
        kernel: Kernel,
        results: Path,
        arguments: Iterable[str],
        append: str = "",
        fake: FakePort | None = None,
    ) -> None:
        self.results = results.resolve()
        (self.results / "place").write_text(f"{self.results}\n")
        command = shlex.join([sys.executable, "-m", *arguments])
        (self.results / "job.sh").write_text(f"cd {shlex.quote(str(ROOT))}\nexec {command}\n")
        environment = fake.environment() if fake else dict(os.environ)
        self._process = subprocess.Popen(
            _command(kernel, self.results, append, is_faked=fake is not None), env=environment
        )

    def is_running(self) -> bool:
        """It has not powered off yet."""
        return self._process.poll() is None

    def wait(self) -> None:
        """Until it powers off.

        Raises:
            AssertionError: with what was printed, if the job did not end well or in time.
        """
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(TIMEOUT_S)
        self._process.kill()
        self._process.wait()
        code = self.results / "exit-code"
        ended_well = code.exists() and code.read_text().strip() == "0"
        assert ended_well, f"the guest's job failed:\n{self._last_words()}"

    def _last_words(self) -> str:
        logs = [self.results / name for name in ("serial.log", "job.log")]
        return "\n".join(log.read_text(errors="replace")[-3000:] for log in logs if log.exists())

    def trace(self) -> list[Access]:
        """Every access to the port since power-on."""
        lines = (self.results / "trace.log").read_text().splitlines()
        found = (_TRACED.match(line) for line in lines)
        return [
            Access(float(m[1]), m[2] == "write", int(m[3], 16), int(m[4], 16)) for m in found if m
        ]


def _command(kernel: Kernel, results: Path, append: str, is_faked: bool) -> list[str]:
    port = "parallel,id=lpt,path=/dev/parport0" if is_faked else "null,id=lpt"
    folder = str(results).replace(",", ",,")
    return [
        *("qemu-system-x86_64", "-accel", "tcg", "-M", "pc", "-cpu", "max", "-m", "512"),
        *("-nodefaults", "-no-reboot", "-display", "none"),
        *("-serial", f"file:{folder}/serial.log"),
        *("-kernel", str(kernel.image), "-initrd", str(kernel.initrd)),
        *("-append", f"console=ttyS0 panic=-1 quiet {append}"),
        *("-fsdev", "local,id=host,path=/,security_model=none,readonly=on,multidevs=remap"),
        *("-device", "virtio-9p-pci,fsdev=host,mount_tag=host"),
        *("-fsdev", f"local,id=results,path={folder},security_model=none"),
        *("-device", "virtio-9p-pci,fsdev=results,mount_tag=results"),
        *("-chardev", port, "-device", "isa-parallel,chardev=lpt,iobase=0x378,irq=7"),
        *("-msg", "timestamp=on", "-trace", "parallel_ioport_*"),
        *("-D", str(results / "trace.log")),
    ]
