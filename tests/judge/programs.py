"""Small programs for the judge, kept in ``programs.txt``."""

from pathlib import Path

_FILE = Path(__file__).with_name("programs.txt")
_MORE = _FILE.with_name("more_axes.txt")


def topics() -> dict[str, list[str]]:
    """The programs of each topic as text."""
    return _topics(_FILE)


def topics_of_more_axes() -> dict[str, list[str]]:
    """The same for machines with other axes; a topic is named by them."""
    return _topics(_MORE)


def _topics(path: Path) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    programs: list[str] = []
    for line in path.read_text(encoding="utf-8").splitlines():
        if line.startswith("[") and line.endswith("]"):
            programs = found.setdefault(line[1:-1], [])
        elif line and not line.startswith("# "):
            programs.append("\n".join((*(part.strip() for part in line.split("|")), "m2", "")))
    return found
