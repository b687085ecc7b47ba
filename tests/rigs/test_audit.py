"""The audit of dependencies: what it looks at, and that a hole is never passed over."""

import subprocess
from typing import Any

import pytest

from rigs import audit


def test_what_a_user_gets_is_looked_at() -> None:
    packages = audit.needed()
    assert {"textual", "pydantic", "pyserial", "numpy", "rich"} <= set(packages)
    assert not {"pytest", "mypy", "ruff", "fraese"} & set(packages)


def _answer(monkeypatch: pytest.MonkeyPatch, stdout: str) -> None:
    def run(command: list[str], **options: Any) -> "subprocess.CompletedProcess[str]":
        return subprocess.CompletedProcess(command, 1, stdout, "")

    monkeypatch.setattr(subprocess, "run", run)


def test_a_hole_fails(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    hole = '{"id": "CVE-1", "fix_versions": ["2.0"]}'
    rows = f'{{"name": "textual", "version": "1.0", "vulns": [{hole}]}}'
    _answer(monkeypatch, f'{{"dependencies": [{rows}]}}')
    assert audit.main() == 1
    assert "textual 1.0: CVE-1, mended in 2.0" in capsys.readouterr().out


@pytest.mark.parametrize(
    "stdout",
    ["", "no network", '{"dependencies": [{"name": "textual", "skip_reason": "not found"}]}'],
)
def test_where_nobody_answers_it_says_so(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], stdout: str
) -> None:
    _answer(monkeypatch, stdout)
    assert audit.main() == 0
    assert "not audited" in capsys.readouterr().out
