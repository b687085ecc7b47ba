"""Nobody from outside, and no file: what the source does not do, nor a running program has.

State files and folders: ``tests/journal``; dependencies: ``tests/rigs/test_audit.py``.
"""

import ast
import os
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
#: A shell, or text that is run.
_RUN = {
    "system",
    "popen",
    "getoutput",
    "getstatusoutput",
    "eval",
    "exec",
    "create_subprocess_shell",
}
#: A network, where sockets are known at all.
_SERVE = {".listen", ".bind", ".create_server", ".start_server", ".serve_forever"}
_NETWORKS = {"socket", "socketserver", "asyncio", "http", "xmlrpc"}
#: What looks like it, or is asked for by name and nowhere else.
_MEANT = {
    # The name of a shell, for which a text is made.
    ("cli/completion.py", "get_completion_script"),
    # `fraese serve --tcp`: this computer only, unless it is said who may come.
    ("serve/tcp.py", ".create_server"),
}
#: Objects from bytes: between a program and its own child, on a pipe that nobody else has.
_PICKLES = {
    "program/looker.py",
    "program/lookthrough.py",
    "motor/realtime/process.py",
    "motor/realtime/child.py",
}


def _trees() -> list[tuple[str, ast.Module]]:
    package = ROOT / "fraese"
    return [
        (path.relative_to(package).as_posix(), ast.parse(path.read_text("utf-8")))
        for path in sorted(package.rglob("*.py"))
    ]


def _imported(tree: ast.Module) -> set[str]:
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {each.name.partition(".")[0] for each in node.names}
        elif isinstance(node, ast.ImportFrom):
            found.add((node.module or "").partition(".")[0])
    return found


def _called(call: ast.Call) -> str:
    function = call.func
    if isinstance(function, ast.Attribute):
        return f".{function.attr}"
    return function.id if isinstance(function, ast.Name) else ""


def test_no_shell_is_called_no_text_is_run_and_nothing_listens() -> None:
    found, meant = [], set()
    for name, tree in _trees():
        wrong = _RUN | (_SERVE if _imported(tree) & _NETWORKS else set())
        for node in ast.walk(tree):
            if not isinstance(node, ast.Call):
                continue
            shell = any(word.arg == "shell" for word in node.keywords)
            if (name, _called(node)) in _MEANT:
                meant.add((name, _called(node)))
            elif shell or _called(node) in wrong:
                found.append((name, node.lineno, _called(node)))
    assert found == []
    assert meant == _MEANT


def test_objects_come_from_bytes_of_our_own_children_only() -> None:
    users = {name for name, tree in _trees() if _imported(tree) & {"pickle", "marshal", "shelve"}}
    assert users <= _PICKLES


@pytest.mark.alone
@pytest.mark.skipif(not Path("/proc/net/tcp").exists(), reason="sockets cannot be looked at here")
def test_a_running_app_has_no_socket_of_a_network(tmp_path: Path) -> None:
    from tests.ui.test_bad_terminals import QUIT, app

    with app(tmp_path) as pty:
        pty.read_until(b"Hold")
        folder = Path(f"/proc/{pty.process.pid}")
        links = [os.readlink(each) for each in (folder / "fd").iterdir()]
        inodes = {found[1] for link in links if (found := re.match(r"socket:\[(\d+)\]", link))}
        assert inodes, "it hears signals by a pair of sockets"
        for table in ("tcp", "tcp6", "udp", "udp6", "raw"):
            path = folder / "net" / table
            for line in path.read_text().splitlines()[1:] if path.exists() else ():
                assert line.split()[9] not in inodes
        pty.type(QUIT)
        assert pty.end(reading=True) == 0
