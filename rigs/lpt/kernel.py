"""The guest's kernel and its first file system, made once from Debian's own package.

    apt-get download linux-image-6.1.0-*-amd64
        --> vmlinuz, a few modules --> cpio with busybox and init.sh --> .rig-cache/kernel-*/

Rule 1: the package is unpacked, never installed. The cloud kernel will not do: it has no parport.
Rule 2: everything is made beside its place and moved there when it is whole.
"""

import lzma
import platform
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).parents[2]
CACHE: Final = ROOT / ".rig-cache"

#: Loaded by the guest's init, with what they depend on, in this order.
BOOT_MODULES: Final = ("virtio_pci", "9pnet_virtio", "9p", "parport_pc", "ppdev")
#: SavedState at hand for scenarios.
SPARE_MODULES: Final = ("lp",)

#: Commands, and the Debian package of each.
COMMANDS: Final = {
    "qemu-system-x86_64": "qemu-system-x86",
    "busybox": "busybox-static",
    "cpio": "cpio",
    "dpkg-deb": "dpkg",
    "apt-get": "apt",
}

_DEPENDS: Final = re.compile(rb"(?:^|\0)depends=([^\0]*)\0")
_WANTED: Final = re.compile(r"\./(boot/vmlinuz-.*|(usr/)?lib/modules/.*/kernel/.*\.ko(\.xz)?)")
_FOLDERS: Final = ("parport", "virtio", "9p", "netfs", "fscache", "char")


class NotHere(Exception):
    """The rig cannot run on this machine; the message names what is missing."""


@dataclass(frozen=True)
class Kernel:
    """What QEMU boots.

    Attributes:
        folder: where it is cached.
    """

    folder: Path

    @property
    def image(self) -> Path:
        """The kernel itself."""
        return self.folder / "vmlinuz"

    @property
    def initrd(self) -> Path:
        """Busybox, modules, init."""
        return self.folder / "initrd"

    def module(self, name: str) -> Path:
        """A module's file; the guest sees it under the same path."""
        return self.folder / "modules" / f"{name}.ko"


def kernel() -> Kernel:
    """The cached kernel, or a fresh one.

    Raises:
        NotHere: if something is missing that it takes.
    """
    _require_commands()
    init = Path(__file__).with_name("init.sh")
    cached = sorted(CACHE.glob("kernel-*/initrd"))
    if cached and cached[-1].stat().st_mtime > init.stat().st_mtime:
        return Kernel(cached[-1].parent)
    CACHE.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory(dir=CACHE) as folder:
        made = Kernel(Path(folder) / "new")
        (made.folder / "modules").mkdir(parents=True)
        package = _download(Path(folder))
        _unpack(package, made)
        _pack_initrd(made, init)
        place = CACHE / f"kernel-{package.name.split('_')[0]}"
        shutil.rmtree(place, ignore_errors=True)
        made.folder.rename(place)
    return Kernel(place)


def _require_commands() -> None:
    if sys.platform != "linux" or platform.machine() != "x86_64":
        raise NotHere("the real-kernel rig needs Linux on x86_64")
    missing = [package for command, package in COMMANDS.items() if not shutil.which(command)]
    if missing:
        raise NotHere(f"missing: apt-get install --no-install-recommends {' '.join(missing)}")
    if b"/ld-linux" in _busybox().read_bytes():
        raise NotHere("busybox is not static: apt-get install busybox-static")


def _busybox() -> Path:
    return Path(shutil.which("busybox") or "busybox").resolve()


def _download(folder: Path) -> Path:
    """The package of the newest kernel that this Debian has."""
    depends = _run("apt-cache", "depends", "linux-image-amd64").stdout
    names = re.findall(r"Depends: (linux-image-[0-9]\S*)", depends)
    if not names:
        raise NotHere("no package linux-image-amd64 is known here: apt-get update, on Debian")
    if _run("apt-get", "download", "-qq", names[0], cwd=folder).returncode:
        # The lists may be older than the mirror.
        _run("apt-get", "update", "-qq")
        _run("apt-get", "download", "-qq", names[0], cwd=folder)
    packages = list(folder.glob("linux-image-*.deb"))
    if not packages:
        raise NotHere(f"the package {names[0]} cannot be had: apt-get download {names[0]}")
    return packages[0]


def _unpack(package: Path, kernel: Kernel) -> None:
    """Take the kernel and a few folders of modules out of the package, uncompressed."""
    command = ["dpkg-deb", "--fsys-tarfile", str(package)]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as process:
        with tarfile.open(fileobj=process.stdout, mode="r|") as archive:
            for member in archive:
                if member.isfile() and _WANTED.fullmatch(member.name):
                    _keep(archive, member, kernel)
        assert process.stdout is not None
        process.stdout.read()


def _keep(archive: tarfile.TarFile, member: tarfile.TarInfo, kernel: Kernel) -> None:
    name = Path(member.name)
    file = archive.extractfile(member)
    assert file is not None
    if name.name.startswith("vmlinuz"):
        kernel.image.write_bytes(file.read())
    elif any(part in _FOLDERS for part in name.parts):
        content = file.read()
        plain = lzma.decompress(content) if name.suffix == ".xz" else content
        kernel.module(name.name.split(".")[0]).write_bytes(plain)


def _pack_initrd(kernel: Kernel, init: Path) -> None:
    tree = kernel.folder / "tree"
    for name in ("bin", "mods", "proc", "sys", "dev", "root", "out"):
        (tree / name).mkdir(parents=True)
    order: list[str] = []
    for name in BOOT_MODULES:
        _with_dependencies(kernel, name, order)
    for name in order:
        shutil.copy(kernel.module(name), tree / "mods")
    (tree / "mods/order").write_text("".join(f"{name}\n" for name in order))
    for name in SPARE_MODULES:
        assert kernel.module(name).exists(), f"the package has no module {name}"
    shutil.copy(_busybox(), tree / "bin/busybox")
    shutil.copy(init, tree / "init")
    (tree / "init").chmod(0o755)
    names = "".join(f"{path.relative_to(tree)}\n" for path in sorted(tree.rglob("*")))
    with kernel.initrd.open("wb") as file:
        command = ["cpio", "--create", "--format=newc", "--quiet"]
        subprocess.run(command, input=names.encode(), stdout=file, cwd=tree, check=True)
    shutil.rmtree(tree)


def _with_dependencies(kernel: Kernel, name: str, order: list[str]) -> None:
    """Dependencies first. One that the package lacks is built into the kernel."""
    file = kernel.module(name)
    if name in order or not file.exists():
        return
    found = _DEPENDS.search(file.read_bytes())
    for other in found[1].decode().split(",") if found else []:
        _with_dependencies(kernel, other, order)
    order.append(name)


def _run(*command: str, cwd: Path | None = None) -> "subprocess.CompletedProcess[str]":
    return subprocess.run(command, capture_output=True, text=True, cwd=cwd, check=False)
