"""File systems of an attempt's own: small, soon full, and of which a cut leaves what is synced."""

import contextlib
import os
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Final

_NEEDED: Final = {"mkfs.ext4": "e2fsprogs", "mount": "mount", "losetup": "mount"}
_IMAGE_BYTES: Final = 8 << 20


def missing() -> str:
    """Why nothing can be mounted here; empty if it can."""
    if os.geteuid():
        return "only root may mount the small file systems of these attempts"
    if not Path("/dev/loop-control").exists():
        return "this kernel has no loop devices"
    lacking = [package for name, package in _NEEDED.items() if not shutil.which(name)]
    return f"apt-get install {' '.join(lacking)}" if lacking else ""


def _run(*words: object) -> str:
    done = subprocess.run([*map(str, words)], check=True, capture_output=True, text=True)
    return done.stdout


@contextlib.contextmanager
def mounted(where: Path, *words: object) -> Iterator[Path]:
    """Mount with these words of ``mount``; whoever still uses it afterwards keeps it."""
    where.mkdir(exist_ok=True)
    _run("mount", *words, where)
    try:
        yield where
    finally:
        _run("umount", "--lazy", where)


def small(where: Path, kilobytes: int) -> contextlib.AbstractContextManager[Path]:
    """A file system in memory."""
    return mounted(where, "-t", "tmpfs", "-o", f"size={kilobytes}k,mode=0700", "tmpfs")


class Disk:
    """A disk as a file, with a journalling file system on it.

    Args:
        image: the file.
        fresh: it is made; else it is what a power cut left.
    """

    def __init__(self, image: Path, *, fresh: bool = True) -> None:
        self.image = image
        if fresh:
            with image.open("wb") as file:
                file.truncate(_IMAGE_BYTES)
            _run("mkfs.ext4", "-q", "-F", "-b", "1024", image)

    def on(self, where: Path) -> contextlib.AbstractContextManager[Path]:
        """Plug it in; after an error it can only be read."""
        return mounted(where, "-o", "loop,errors=remount-ro", self.image)

    def as_cut(self, to: Path) -> "Disk":
        """What is on it now, without what was not synced."""
        shutil.copyfile(self.image, to)
        return Disk(to, fresh=False)

    def fail(self) -> None:
        """An error of the disk: from now on it can only be read."""
        said = _run("losetup", "--noheadings", "--output", "NAME", "--associated", self.image)
        name = said.split()[0].rpartition("/")[2]
        Path(f"/sys/fs/ext4/{name}/trigger_fs_error").write_text("campaign")


def fill(folder: Path) -> Path:
    """No byte more fits there; what was put there for that."""
    filler = folder / "filler"
    with filler.open("ab", buffering=0) as file, contextlib.suppress(OSError):
        for size in (4096, 1):
            with contextlib.suppress(OSError):
                while True:
                    file.write(bytes(size))
    return filler
