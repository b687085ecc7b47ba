"""Small programs for the judge, kept in ``programs.txt``."""

from pathlib import Path

_FILE = Path(__file__).with_name("programs.txt")


def topics() -> dict[str, list[str]]:
    """The programs of each topic as text."""
    found: dict[str, list[str]] = {}
    programs: list[str] = []
    for line in _FILE.read_text(encoding="utf-8").splitlines():
        if line.startswith("[") and line.endswith("]"):
            programs = found.setdefault(line[1:-1], [])
        elif line and not line.startswith("# "):
            programs.append("\n".join((*(part.strip() for part in line.split("|")), "m2", "")))
    return found
