"""What somebody has who installs it: from the wheel, made of the source archive, in a new place."""

import os
import shutil
import subprocess
import sys
import tarfile
import tomllib
from pathlib import Path
from typing import Final, NamedTuple

import pytest

from rigs import manual

ROOT: Final = Path(__file__).parents[2]
VERSION: Final = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["version"]
#: What comes from a registry takes as long as that.
_PATIENCE_S: Final = 400

#: pip cannot reach where packages come from.
_NO_NETWORK: Final = "connection broken by"

pytestmark = pytest.mark.alone


class Home(NamedTuple):
    """A place where it is installed.

    Attributes:
        place: the environment.
        archive: the source archive that the wheel was made of.
        folder: to work in.
    """

    place: Path
    archive: Path
    folder: Path

    def run(self, program: str, *words: str, cwd: Path | None = None) -> str:
        """A program of the environment, which must go well; what it printed."""
        kept = ("PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV", "FRAESE_LANGUAGE")
        own = {name: value for name, value in os.environ.items() if name not in kept}
        own |= {"HOME": str(self.folder), "LANG": "C.UTF-8"}
        own |= {f"XDG_{name}_HOME": str(self.folder / name) for name in ("CONFIG", "STATE")}
        done = subprocess.run(
            [str(self.place / "bin" / program), *words],
            cwd=cwd or self.folder, env=own, capture_output=True, text=True,
            timeout=_PATIENCE_S, check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout


def _called(*words: str, cwd: Path) -> None:
    # What can be compiled is not: that takes minutes, and is tried elsewhere.
    own = {**os.environ, "FRAESE_PLAIN": "1"}
    done = subprocess.run(
        words, cwd=cwd, env=own, capture_output=True, text=True, timeout=_PATIENCE_S, check=False
    )
    if done.returncode and _NO_NETWORK in done.stderr:
        pytest.skip(f"needs a package registry, which cannot be reached: {done.stderr[-300:]}")
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]


def _tracked() -> list[str]:
    """Files of the tree, new ones among them."""
    command = ["git", "ls-files", "-co", "--exclude-standard"]
    listed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    return [name for name in listed.stdout.splitlines() if (ROOT / name).is_file()]


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Home:
    """Built, and installed into an environment that has nothing of ours."""
    place = tmp_path_factory.mktemp("home")
    tree, made = place / "tree", place / "made"
    for name in _tracked():
        (tree / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / name, tree / name)
    # First the archive, then the wheel out of it.
    _called(sys.executable, "-m", "build", "--no-isolation", "-o", str(made), cwd=tree)
    (wheel,), (archive,) = made.glob("*.whl"), made.glob("*.tar.gz")
    # Without a pip of its own, and without compiling what is used once: half of the time.
    _called(sys.executable, "-m", "venv", "--without-pip", "env", cwd=place)
    pip = (sys.executable, "-m", "pip", "--python", str(place / "env" / "bin" / "python"))
    quiet = ("-q", "--disable-pip-version-check", "--no-compile")
    _called(*pip, "install", *quiet, str(wheel), "pytest", cwd=place)
    (place / "work").mkdir()
    return Home(place / "env", archive, place / "work")


def test_it_is_the_version_that_the_project_says(home: Home) -> None:
    assert home.run("fraese", "--version") == f"fraese {VERSION}, plain\n"


def test_the_archive_is_the_whole_tree(home: Home) -> None:
    with tarfile.open(home.archive) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    assert set(_tracked()) - names == set()


def test_the_example_of_a_harness_passes_there(home: Home) -> None:
    project = home.folder / "harness"
    shutil.copytree(
        ROOT / "examples" / "harness", project, ignore=shutil.ignore_patterns("__pycache__", ".*")
    )
    said = home.run("pytest", "-p", "no:cacheprovider", cwd=project)
    assert "9 passed" in said


def test_a_session_goes_as_in_the_readme(home: Home) -> None:
    home.run("fraese", "home")
    shutil.copy(ROOT / "examples" / "plate.ngc", home.folder)
    home.run("fraese", "check", "plate.ngc")
    home.run("fraese", "run", "plate.ngc", "--yes")
    assert "X 0.000" not in home.run("fraese", "where")


def test_the_firmware_is_there_for_every_board(home: Home) -> None:
    for board in ("uno", "nano", "mega"):
        words = ("bridge", "flash", "--device", "any", "--board", board, "--dry-run")
        said = home.run("fraese", *words)
        image = Path(said.splitlines()[0].split("flash:w:")[1].removesuffix(":i"))
        assert image.is_relative_to(home.place)
        assert image.read_text("ascii").endswith(":00000001FF\n")


def test_manual_completion_and_menu_entry_are_where_they_are_looked_for(home: Home) -> None:
    share = home.place / "share"
    for place, text in manual.shared_files().items():
        assert (share / place).read_text("utf-8") == text
    assert "Exec=fraese" in (share / "applications" / "fraese.desktop").read_text("utf-8")


def test_a_shell_completes_commands_and_options(home: Home) -> None:
    script = home.place / "share" / "bash-completion" / "completions" / "fraese"
    ask = (
        f'PATH="{home.place}/bin:$PATH"; . "{script}"; COMP_WORDS=(fraese probe); COMP_CWORD=1;'
        ' _fraese_completion fraese; echo "${COMPREPLY[@]}"'
    )
    done = subprocess.run(["bash", "-c", ask], capture_output=True, text=True, check=True)
    assert done.stdout == "probe-map\n"
