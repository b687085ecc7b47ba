"""Copies of the programs that ran last, so that one can be gone on with when its file is gone.

    jobs/<SHA-256>         what a file held, a program's, a subroutine's or a height map's
    jobs/<SHA-256>.json    of a program: its name, and which other files belong to it

Rule 1: a copy is found by what it holds, and believed only if it still holds it.
Rule 2: only the last few programs are kept, and no more than so many bytes.
Rule 3: for nobody else's eyes; what lies there by another name, or as a link, is not followed.
"""

import json
import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Final

from fraese.errors import ProgramError
from fraese.phrases import phrase, reason
from fraese.program.content import Content, take
from fraese.program.mapped import TakenMap, map_of
from fraese.program.taken import Taken

FOLDER: Final = "jobs"
_MOST_PROGRAMS: Final = 5
_MOST_BYTES: Final = 256 << 20
_INDEX: Final = ".json"
_NEW: Final = ".new"
_CHUNK_BYTES: Final = 1 << 18


class KeptPrograms:
    """The folder of copies.

    Args:
        folder: the state folder.

    Attributes:
        state_folder: likewise.
    """

    def __init__(self, folder: Path) -> None:
        self.state_folder = folder
        self._folder = folder / FOLDER

    def keep(self, taken: Taken, also: Content | None = None) -> None:
        """Keep a program; durable when this returns.

        Args:
            taken: its files.
            also: another file that it is run with, a height map.

        Raises:
            ProgramError: it is too large, or cannot be written.
        """
        others = (*taken.files.values(), also)
        contents = [taken.main, *(file for file in others if file is not None)]
        if sum(content.size for content in contents) > _MOST_BYTES:
            raise ProgramError(
                phrase(
                    "no copy is kept, since it is larger than {most_bytes} MB; to go on with"
                    " it later, leave the file as it is.",
                    most_bytes=_MOST_BYTES >> 20,
                ),
                file=taken.path.name,
            )
        try:
            for folder in (self._folder.parent, self._folder):
                folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            for content in contents:
                self._write(content.content_hash, content)
            index = _index_of(taken, also).encode()
            self._write(taken.main.content_hash + _INDEX, index)
            self._make_room(taken.main.content_hash)
            _sync(self._folder)
        except OSError as error:
            raise ProgramError(
                phrase(
                    "no copy can be kept: {reason}; to go on with it later, leave the file"
                    " as it is.",
                    reason=reason(error),
                ),
                file=taken.path.name,
            ) from error

    def find(self, content_hash: str) -> Taken:
        """A program that was kept.

        Raises:
            ProgramError: it is not there any more, or damaged.
        """
        try:
            index = json.loads(_bytes_of(self._folder / (content_hash + _INDEX)))
            path = Path(index["path"])
            files = {
                Path(name): None if kept is None else self._content(kept, name)
                for name, kept in index["files"].items()
            }
            return Taken(path, self._content(content_hash, index["path"]), files)
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            raise ProgramError(
                phrase("the kept copy of this program is gone or damaged.")
            ) from error

    def find_map(self, path: Path, content_hash: str) -> TakenMap:
        """A height map with which a program was run.

        Raises:
            ProgramError: it is not there any more, or damaged.
        """
        try:
            return map_of(path, self._content(content_hash, path.name))
        except ValueError as error:
            raise ProgramError(
                phrase(
                    "the kept copy of this height map is gone or damaged: what was run with it is"
                    " not gone on with without it."
                ),
                file=path.name,
            ) from error

    def _content(self, content_hash: str, file: str) -> Content:
        content = take(self._folder / content_hash, file)
        if content is None or content.content_hash != content_hash:
            raise ValueError(content_hash)
        # The copy is no file that anybody edits.
        content.stamp = None
        return content

    def _write(self, name: str, what: Content | bytes) -> None:
        """A whole file or none; what is there already by this name holds this already."""
        path = self._folder / name
        if isinstance(what, Content) and _holds(path, what):
            return
        new = path.with_name(name + _NEW)
        with suppress(FileNotFoundError):
            new.unlink()
        flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_NOFOLLOW", 0)
        with os.fdopen(os.open(new, flags, 0o600), "wb") as file:
            for chunk in _chunks(what):
                file.write(chunk)
            file.flush()
            os.fsync(file.fileno())
        new.replace(path)

    def _make_room(self, newest: str) -> None:
        """Remove what is beyond the last few, and what no program needs."""
        indexes = sorted(
            self._folder.glob("*" + _INDEX),
            key=lambda path: (path.stem == newest, path.lstat().st_mtime_ns),
            reverse=True,
        )
        needed: dict[str, int] = {}
        for index in indexes[:_MOST_PROGRAMS]:
            also = {name: self._size(name) for name in _needed_by(index)}
            if needed and sum({**needed, **also}.values()) > _MOST_BYTES:
                break
            needed |= also
        for path in self._folder.iterdir():
            if path.name not in needed:
                with suppress(OSError):
                    path.unlink()

    def _size(self, name: str) -> int:
        with suppress(OSError):
            return (self._folder / name).lstat().st_size
        return 0


def _index_of(taken: Taken, also: Content | None) -> str:
    files = {str(path): file and file.content_hash for path, file in taken.files.items()}
    others = [also.content_hash] if also is not None else []
    index = {"path": str(taken.path), "files": files, "also": others}
    return json.dumps(index, indent=1) + "\n"


def _needed_by(index: Path) -> list[str]:
    """Names of the files of one program, its index among them."""
    names = [index.name, index.stem]
    with suppress(ValueError, KeyError, AttributeError, TypeError):
        found = json.loads(_bytes_of(index))
        names += [str(kept) for kept in found["files"].values() if kept]
        names += [str(kept) for kept in found.get("also", ())]
    return names


def _bytes_of(path: Path) -> bytes:
    content = take(path)
    if content is None:
        raise ValueError(path.name)
    with content.open() as stream:
        return stream.read()


def _holds(path: Path, content: Content) -> bool:
    """Whether a plain file lies there that holds just this."""
    if path.is_symlink():
        return False
    try:
        there = take(path)
    except ProgramError:
        return False
    return there is not None and there.content_hash == content.content_hash


def _chunks(what: Content | bytes) -> Iterator[bytes]:
    if isinstance(what, bytes):
        yield what
        return
    with what.open() as stream:
        while chunk := stream.read(_CHUNK_BYTES):
            yield chunk


def _sync(folder: Path) -> None:
    """What was renamed is durable; where folders cannot be opened, there is no such thing."""
    with suppress(PermissionError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
