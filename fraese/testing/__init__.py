"""A simulated machine for tests of one's own: G-code, macros, programs that drive ``fraese``.

    def test_the_pocket(mill):
        mill.home()
        done = mill.run(Path("pocket.ngc"), answers=[""])
        assert mill.carriages_mm["z"] == pytest.approx(0)
        assert not any(done.lost_steps.values())

With pytest installed the fixtures ``mill`` and ``app`` are there without an import (``plugin.py``);
without it, ``Mill`` and ``App`` are context managers. See docs/testing.md.

Rule 1: time is virtual: a test takes as long as the computer needs, and does the same every time.
Rule 2: nothing waits for ever. A question has an answerer, or raises; every run has a limit.
Rule 3: what is not asked for is not imported: pytest loads the plugin for everybody.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from fraese.testing.app import App
    from fraese.testing.failures import (
        DrivenByKeys,
        HarnessError,
        HasEnded,
        NeverCame,
        NoSuchName,
        TookTooLong,
        Unanswered,
    )
    from fraese.testing.hands import Hands
    from fraese.testing.lines import Edge, Lines
    from fraese.testing.mill import Mill, Run

__all__ = [
    "App",
    "DrivenByKeys",
    "Edge",
    "Hands",
    "HarnessError",
    "HasEnded",
    "Lines",
    "Mill",
    "NeverCame",
    "NoSuchName",
    "Run",
    "TookTooLong",
    "Unanswered",
]

_MODULES: Final = {
    "App": "app",
    "Edge": "lines",
    "Hands": "hands",
    "Lines": "lines",
    "Mill": "mill",
    "Run": "mill",
}


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(name)
    module = _MODULES.get(name, "failures")
    return getattr(import_module(f"{__name__}.{module}"), name)
