"""The picture of docs/waveforms.md: the page's own examples, carried out.

Run: python -m bench.waveform
"""

import os
import re
import subprocess
import tempfile
from pathlib import Path

_ROOT = Path(__file__).parents[1]
MANUAL, PICTURE = _ROOT / "docs" / "waveforms.md", _ROOT / "docs" / "waveform.svg"
_FILE = "there-and-back.vcd"


def examples() -> list[str]:
    """The commands of the page that make that file, and the stretch of it that it shows last."""
    found = re.findall(r"^    \$ (.*)$", MANUAL.read_text("utf-8"), re.MULTILINE)
    of_file = [words for words in found if _FILE in words]
    return [of_file[0], f"{of_file[-1]} --svg {PICTURE.name}"]


def main() -> None:
    """Draw it."""
    own = {**os.environ, "PATH": f"{_ROOT / '.venv' / 'bin'}{os.pathsep}{os.environ['PATH']}"}
    with tempfile.TemporaryDirectory() as place:
        for words in examples():
            subprocess.run(["sh", "-c", words], cwd=place, check=True, env=own, capture_output=True)
        PICTURE.write_text((Path(place) / PICTURE.name).read_text("utf-8"), "utf-8")
    print(PICTURE)


if __name__ == "__main__":
    main()
