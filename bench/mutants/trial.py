"""A copy of the tree, and faults tried in it one after the other."""

import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterable, Sequence
from contextlib import suppress
from enum import Enum
from pathlib import Path
from typing import Final

from bench.mutants.mutant import ROOT, Mutant

#: Not part of the tree: what is made from it, and what is kept beside it.
_LEFT_OUT: Final = (
    ".git", ".venv", ".*_cache", ".hypothesis", ".coverage*", "__pycache__", "*.egg-info", "build",
)  # fmt: skip
_PASSED, _FAILED = 0, 1
_FIRST_FAILED: Final = re.compile(r"^(?:FAILED|ERROR) (\S+)", re.MULTILINE)
_SOME_PASSED: Final = re.compile(r"\d+ passed|^\.", re.MULTILINE)


class Verdict(Enum):
    """What the tests made of a fault."""

    KILLED = "killed"
    HUNG = "killed, by the time limit"
    SURVIVED = "SURVIVED"
    SKIPPED = "not tried: the tests skip here"
    BROKEN = "BROKEN: the tests cannot be run with it"


class Trial:
    """A copy of the tree.

    Args:
        folder: an empty one, for the copy.
    """

    def __init__(self, folder: Path) -> None:
        self._tree = folder / "tree"
        shutil.copytree(ROOT, self._tree, ignore=shutil.ignore_patterns(*_LEFT_OUT), symlinks=True)
        self._env = {
            **os.environ,
            "PYTHONPATH": str(self._tree),
            "PYTHONDONTWRITEBYTECODE": "1",
        }
        # Two faults of one length within a second: only a checksum tells their files apart.
        self._python("-m", "compileall", "-q", "--invalidation-mode", "checked-hash", "fraese")
        where = self._python("-c", "import fraese; print(fraese.__file__)").stdout
        if not Path(where.strip()).is_relative_to(self._tree):
            raise RuntimeError(f"the copy is not what would be tried: fraese is {where.strip()}")

    def failure(self, tests: Iterable[str]) -> str:
        """The first of these tests that the copy fails as it is; empty: none."""
        code, said = self._pytest(sorted(set(tests)), None)
        return "" if code == _PASSED else next(iter(_FIRST_FAILED.findall(said)), said)

    def verdict(self, mutant: Mutant) -> tuple[Verdict, str]:
        """Put the fault in, run the tests, take it out; also says which test failed first."""
        file = self._tree / mutant.file
        text = file.read_text("utf-8")
        file.write_text(mutant.applied_to(text), "utf-8")
        try:
            if not self._builds(mutant.file):
                return Verdict.BROKEN, "it does not compile"
            code, said = self._pytest(mutant.tests, mutant.limit_s)
        except subprocess.TimeoutExpired:
            return Verdict.HUNG, ""
        finally:
            file.write_text(text, "utf-8")
        if code == _FAILED:
            return Verdict.KILLED, next(iter(_FIRST_FAILED.findall(said)), "")
        if code != _PASSED:
            return Verdict.BROKEN, said
        return (Verdict.SURVIVED if _SOME_PASSED.search(said) else Verdict.SKIPPED), ""

    def _builds(self, file: str) -> bool:
        """A fault that does not compile is none."""
        if not file.startswith("firmware/"):
            return True
        command = ["make", "-s", "-C", str(self._tree / "firmware"), "BAUD=250000"]
        return subprocess.run(command, capture_output=True, check=False).returncode == 0

    def _pytest(self, tests: Sequence[str], limit_s: float | None) -> tuple[int, str]:
        """How pytest ended, and what it said."""
        command = [sys.executable, "-m", "pytest", "-x", "-p", "no:cacheprovider", "--tb=line"]
        process = subprocess.Popen(
            [*command, *tests],
            cwd=self._tree,
            env=self._env,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )
        try:
            said, _ = process.communicate(timeout=limit_s)
        finally:
            # Whatever the tests have started goes with them.
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()
        return process.returncode, said

    def _python(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, *arguments],
            cwd=self._tree,
            env=self._env,
            check=True,
            capture_output=True,
            text=True,
        )
