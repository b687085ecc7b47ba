"""Builds the harness and small firmwares, on demand, into `.rig-cache/` of the checkout.

A file's name carries a hash of everything it was made from, so nothing stale is ever used and two
processes, or threads, may build the same file at the same time.
"""

import functools
import hashlib
import os
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from uuid import uuid4

HERE = Path(__file__).resolve().parent
CACHE = HERE.parent.parent / ".rig-cache"
MCU = "atmega328p"
F_CPU_HZ = 16_000_000

#: Where the linker puts the data space.
DATA_SPACE = 0x800000

CORE_SOURCES = ("simcore.c", "simwire.c", "simuart.c", "simtimer.c", "simpins.c")
HOST_SOURCES = ("simtty.c", "simoptions.c", "simhost.c")
HEADERS = ("simcore.h", "simstate.h", "simtty.h", "simoptions.h")
HOST_FLAGS = ("-std=gnu11", "-O2", "-Wall", "-Wextra", "-Werror", "-I/usr/include/simavr")
AVR_FLAGS = (f"-mmcu={MCU}", f"-DF_CPU={F_CPU_HZ}UL", "-std=gnu11", "-Os", "-Wall", "-Wextra")

#: What must be there, and the Debian package that brings it.
NEEDED = {
    "gcc": "gcc",
    "/usr/include/stdlib.h": "libc6-dev",
    "avr-gcc": "gcc-avr",
    "avr-objdump": "binutils-avr",
    "/usr/lib/avr/include/avr/io.h": "avr-libc",
    "/usr/include/simavr/sim_avr.h": "libsimavr-dev",
    "/usr/include/libelf.h": "libelf-dev",
}


class RigError(Exception):
    """The rig cannot be built, or was used wrongly."""


def missing() -> str:
    """Which Debian packages are missing, as a sentence for a skip; empty when nothing is."""
    absent = [
        package
        for what, package in NEEDED.items()
        if not (Path(what).exists() if what.startswith("/") else shutil.which(what))
    ]
    return f"needs the Debian packages {' '.join(absent)}" if absent else ""


@functools.cache
def core_library() -> Path:
    """The harness as a shared object, for `ctypes`.

    Raises:
        RigError: A package is missing or the compiler refuses.
    """
    sources = [HERE / name for name in CORE_SOURCES]
    command = ["gcc", *HOST_FLAGS, "-shared", "-fPIC"]
    return _built("libsimcore", ".so", command, sources, ("-lsimavr", "-lelf"))


@functools.cache
def host_program() -> Path:
    """The harness behind a pty, as a program.

    Raises:
        RigError: A package is missing or the compiler refuses.
    """
    sources = [HERE / name for name in (*CORE_SOURCES, *HOST_SOURCES)]
    return _built("simhost", "", ["gcc", *HOST_FLAGS], sources, ("-lsimavr", "-lelf"))


def firmware(*sources: Path, flags: Sequence[str] = ()) -> Path:
    """An image for the ATmega328P from C or assembler files.

    Args:
        sources: What is compiled and linked.
        flags: Further flags, such as `-DBAUD=250000`.

    Raises:
        RigError: A package is missing or the compiler refuses.
    """
    return _built(sources[0].stem, ".elf", ["avr-gcc", *AVR_FLAGS, *flags], list(sources), ())


def data_symbols(elf: Path) -> dict[str, int]:
    """The addresses of an image's variables in the data space, for `Avr.peek`.

    Raises:
        RigError: `avr-nm` refuses.
    """
    done = subprocess.run(["avr-nm", str(elf)], capture_output=True, text=True, check=False)
    if done.returncode:
        raise RigError(f"avr-nm refuses {elf}: {done.stderr}")
    rows = (line.split() for line in done.stdout.splitlines())
    return {row[-1]: int(row[0], 16) - DATA_SPACE for row in rows if row[-2] in "bBdD"}


def _built(
    stem: str, suffix: str, command: list[str], sources: list[Path], libraries: Sequence[str]
) -> Path:
    if absent := missing():
        raise RigError(f"the simavr rig {absent}")
    target = CACHE / f"{stem}-{_fingerprint(command, sources)}{suffix}"
    if target.exists():
        return target
    CACHE.mkdir(exist_ok=True)
    unfinished = target.with_name(f"{target.name}.{uuid4().hex}")
    arguments = [*command, "-o", str(unfinished), *map(str, sources), *libraries]
    done = subprocess.run(arguments, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RigError(f"{command[0]} refuses {sources[0].name}:\n{done.stderr}")
    os.replace(unfinished, target)
    return target


def _fingerprint(command: list[str], sources: list[Path]) -> str:
    digest = hashlib.sha256("\0".join(command).encode())
    headers = [HERE / name for name in HEADERS]
    for source in sorted({*sources, *headers, *_neighbours(sources)}):
        digest.update(source.read_bytes())
    return digest.hexdigest()[:12]


def _neighbours(sources: list[Path]) -> set[Path]:
    """The headers beside the sources: they may be included."""
    return {header for source in sources for header in source.parent.glob("*.h")}


if __name__ == "__main__":
    core_library()
    host_program()
