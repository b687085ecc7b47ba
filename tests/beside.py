"""Packages that live beside ours, as if they were installed: their entry points are found."""

import sys
import tomllib
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

EXAMPLES = Path(__file__).parents[1] / "examples"


def install(folder: Path, monkeypatch: pytest.MonkeyPatch, into: Path) -> None:
    """What ``pip install --editable`` would do with a package, as far as names go.

    Args:
        folder: with a ``pyproject.toml``.
        monkeypatch: takes it back.
        into: an empty folder, in the place of site-packages.
    """
    project = tomllib.loads((folder / "pyproject.toml").read_text("utf-8"))["project"]
    name, version = project["name"], project["version"]
    about = into / f"{name.replace('-', '_')}-{version}.dist-info"
    about.mkdir(parents=True)
    (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n")
    (about / "entry_points.txt").write_text(_listed(project.get("entry-points", {})))
    for path in (str(into), str(folder)):
        monkeypatch.syspath_prepend(path)
    monkeypatch.setenv("PYTHONPATH", f"{into}:{folder}")


def _listed(groups: Mapping[str, Mapping[str, str]]) -> str:
    return "\n".join(
        line
        for group, names in groups.items()
        for line in (f"[{group}]", *(f"{name} = {place}" for name, place in names.items()))
    )


def example(package: str, module: str) -> Any:
    """A module of an example package that is not installed."""
    folder = str(EXAMPLES / package)
    if folder not in sys.path:
        sys.path.append(folder)
    return import_module(module)
