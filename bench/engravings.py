"""The pictures of docs/engrave.md: its own examples, carried out.

Run: python -m bench.engravings
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

_ROOT = Path(__file__).parents[1]
MANUAL, PICTURES = _ROOT / "docs" / "engrave.md", _ROOT / "docs" / "engrave"
EXAMPLES = _ROOT / "examples" / "engrave"


def examples() -> list[list[str]]:
    """The words of every example, in their order, without the first one."""
    found = re.findall(r"^    fraese (.*)$", MANUAL.read_text("utf-8"), re.MULTILINE)
    return [shlex.split(words) for words in found]


def shown() -> set[str]:
    """Pictures that the manual shows."""
    return set(re.findall(r"\(engrave/([\w-]+\.png)\)", MANUAL.read_text("utf-8")))


def main() -> None:
    PICTURES.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as place:
        shutil.copytree(EXAMPLES, place, dirs_exist_ok=True)
        for words in examples():
            command = [sys.executable, "-m", "fraese", *words, "--state", "state"]
            usual = command[:-2] if words[0] == "engrave" else command
            subprocess.run(
                usual, cwd=place, check=True, env={**os.environ, "PYTHONPATH": str(_ROOT)}
            )
        for name in sorted(shown()):
            shutil.copy(Path(place) / name, PICTURES / name)
            print(f"{PICTURES / name}  {(PICTURES / name).stat().st_size // 1000} kB")


if __name__ == "__main__":
    main()
