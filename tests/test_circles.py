"""No circle of imports, in any package, not even among what is imported for types only."""

from collections.abc import Iterable, Mapping
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import grimp
import pytest

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def graph() -> grimp.ImportGraph:
    return grimp.build_graph("fraese", exclude_type_checking_imports=False, cache_dir=None)


def _circle(arrows: Mapping[str, Iterable[str]]) -> list[str]:
    """One circle, if there is any."""
    try:
        tuple(TopologicalSorter(arrows).static_order())
    except CycleError as error:
        return list(error.args[1])
    return []


def _arrows_inside(graph: grimp.ImportGraph, package: str) -> dict[str, set[str]]:
    """Who imports whom among what lies directly in a package, with all that is below."""
    children = graph.find_children(package)

    def child_of(module: str) -> str:
        return next((c for c in children if module == c or module.startswith(f"{c}.")), "")

    arrows: dict[str, set[str]] = {child: set() for child in children}
    for module in graph.modules:
        importer = child_of(module)
        for imported in graph.find_modules_directly_imported_by(module) if importer else ():
            target = child_of(imported)
            if target and target != importer:
                arrows[importer].add(target)
    return arrows


def test_no_circle_among_the_modules(graph: grimp.ImportGraph) -> None:
    assert len(graph.modules) > 100
    assert "fraese.ui.app" in graph.modules
    arrows = {name: graph.find_modules_directly_imported_by(name) for name in graph.modules}
    assert _circle(arrows) == []


def test_no_circle_among_the_parts_of_any_package(graph: grimp.ImportGraph) -> None:
    packages = [name for name in graph.modules if graph.find_children(name)]
    assert {"fraese", "fraese.ui", "fraese.motor.ports"} <= set(packages)
    circles = {name: _circle(_arrows_inside(graph, name)) for name in packages}
    assert {name: circle for name, circle in circles.items() if circle} == {}


def test_an_import_for_types_only_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    house = tmp_path / "little_house"
    house.mkdir()
    (house / "__init__.py").write_text("")
    (house / "below.py").write_text(
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from little_house import above\n"
    )
    (house / "above.py").write_text("from little_house import below\n")
    monkeypatch.syspath_prepend(tmp_path)
    graph = grimp.build_graph("little_house", cache_dir=None)
    assert set(_circle(_arrows_inside(graph, "little_house"))) == {
        "little_house.above",
        "little_house.below",
    }
