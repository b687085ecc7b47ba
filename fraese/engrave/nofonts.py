"""Imports ezdxf without its fonts.

When it is imported, ezdxf looks through all fonts of the computer and writes what it found into the
user's cache folder. Texts are not drawn here, so it is shown a cache in which there is none.
"""

import json
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path as FilePath
from typing import Final

_VARIABLE: Final = "XDG_CACHE_HOME"
#: Of another version it takes no more than that there are none.
_NONE: Final = json.dumps({"version": 2, "font-faces": []})


@contextmanager
def no_fonts() -> Iterator[None]:
    """What is imported meanwhile finds no fonts, and leaves nothing behind."""
    before = os.environ.get(_VARIABLE)
    with tempfile.TemporaryDirectory() as folder:
        cache = FilePath(folder) / "ezdxf"
        cache.mkdir()
        (cache / "font_manager_cache.json").write_text(_NONE, "utf-8")
        os.environ[_VARIABLE] = folder
        try:
            yield
        finally:
            if before is None:
                del os.environ[_VARIABLE]
            else:
                os.environ[_VARIABLE] = before
