"""What a person does by hand and the language does for him: lines that are typed, and probing."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from fraese.control.controller import Controller
from fraese.program.mapping import probe_map
from fraese.program.probing import cycles_for, probe
from fraese.program.typed import run_file, run_text


class ByHand:
    """Handed to who has a keyboard and knows no language."""

    def typed(self, controller: Controller, text: str) -> None:
        """Start lines of G-code; see ``run_text``."""
        run_text(controller, text)

    def macro(self, controller: Controller, name: str, text: str, file: str) -> None:
        """Start lines, or those of a file; see ``run_text``, ``run_file``."""
        if file:
            run_file(controller, Path(file).expanduser(), name)
        else:
            run_text(controller, text, name, Path(f"macro {name}.ngc"))

    def probe(self, controller: Controller, name: str, values: Mapping[str, float]) -> None:
        """Start a probing cycle; see ``probing.probe``."""
        probe(controller, name, values)

    def probe_map(self, controller: Controller, path: Path, values: Mapping[str, float]) -> None:
        """Start to probe a height map from the work zero on; see ``mapping.probe_map``."""
        probe_map(controller, path, values)

    def cycles(self, axes: Sequence[str]) -> tuple[str, ...]:
        """Names of the cycles for these axes."""
        return cycles_for(axes)
