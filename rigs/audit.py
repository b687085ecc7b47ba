"""``python -m rigs.audit``: known holes in what fraese needs to run, as pip-audit knows them.

Only what a user gets is looked at, with what that needs in turn, in the versions installed here:
not the tools of whoever builds it. Where the database cannot be asked, that is said; it is no
failure.
"""

import json
import re
import subprocess
import sys
import tempfile
from importlib import metadata
from pathlib import Path
from typing import Any, Final

_ASK_S: Final = 120
_NAME: Final = re.compile(r"[A-Za-z0-9._-]+")


def needed(project: str = "fraese") -> dict[str, str]:
    """Name and version of every package that the project needs, itself left out."""
    found: dict[str, str] = {}
    waiting = [project]
    while waiting:
        for line in metadata.requires(waiting.pop()) or []:
            # Extras, and what other systems need.
            name = _NAME.match(line)
            if name is None or "extra ==" in line or name[0] in found:
                continue
            try:
                found[name[0]] = metadata.version(name[0])
            except metadata.PackageNotFoundError:
                continue
            waiting.append(name[0])
    return found


def asked(packages: dict[str, str]) -> list[dict[str, Any]] | None:
    """What pip-audit says of each package; None: it could not ask."""
    with tempfile.TemporaryDirectory() as folder:
        pins = Path(folder) / "pins.txt"
        pins.write_text("".join(f"{n}=={v}\n" for n, v in packages.items()), "utf-8")
        command = [sys.executable, "-m", "pip_audit", "-r", str(pins), "--no-deps"]
        command += ["--disable-pip", "--format", "json", "--progress-spinner", "off"]
        try:
            done = subprocess.run(
                [*command, "--timeout", "10"],
                capture_output=True,
                text=True,
                timeout=_ASK_S,
                check=False,
            )
            said = json.loads(done.stdout)["dependencies"]
        except (subprocess.TimeoutExpired, ValueError, KeyError):
            return None
    return [row for row in said if "skip_reason" not in row] or None


def main() -> int:
    """1: there is a known hole."""
    packages = needed()
    rows = asked(packages)
    if rows is None:
        print("dependencies not audited: the list of known holes cannot be asked from here")
        return 0
    bad = [(row, hole) for row in rows for hole in row["vulns"]]
    for row, hole in bad:
        mended = ", ".join(hole["fix_versions"]) or "no version yet"
        print(f"{row['name']} {row['version']}: {hole['id']}, mended in {mended}")
    print(f"{len(rows)} of {len(packages)} dependencies audited, {len(bad)} known holes")
    return int(bool(bad))


if __name__ == "__main__":
    sys.exit(main())
