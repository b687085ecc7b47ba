"""Lines for people: those of the language, read where they are looked at; recent files."""

import os
from pathlib import Path

import pytest

from fraese.errors import ProgramError
from fraese.gcode.text import read_lines
from fraese.program.content import take
from fraese.program.lineindex import LineIndex
from fraese.program.recent import RecentPrograms


def index_of(folder: Path, held: bytes) -> tuple[LineIndex, Path]:
    path = folder / "part.ngc"
    path.write_bytes(held)
    content = take(path)
    assert content is not None
    return LineIndex(content), path


@pytest.mark.parametrize(
    "held",
    [
        b"",
        b"G0 X1",
        b"G0 X1\n",
        b"\nG0 X1\n\n",
        b"a\r\nb\rc\n\rd\r\r\n",
        b"\xef\xbb\xbfG0 X1\nb\n",
        "(Ü und 日本)\nG0\n".encode(),
        b"(\xfc)\nG0 (\xe4\xb8)\n",
        "G0 X1\r\nÜ\n".encode("utf-16"),
        b"x" * 4096 + b"\n",
        "Ü".encode() * 4096 + b"\nG0",
        b"line\n" * 1000 + b"\r" * 300,
    ],
)
def test_lines_are_those_of_the_language(
    tmp_path: Path, held: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Ends of lines fall on the seam between two chunks, too.
    monkeypatch.setattr("fraese.program.lineindex._CHUNK_BYTES", 3)
    index, path = index_of(tmp_path, held)
    assert list(index) == list(read_lines(path))
    assert index[1:3] == list(read_lines(path))[1:3]
    if len(index):
        assert index[-1] == list(read_lines(path))[-1]
    with pytest.raises(IndexError):
        index[len(index)]


def test_a_long_file_in_utf_16_is_there_to_its_end(tmp_path: Path) -> None:
    """As an editor of another system writes it: what lies far behind is shown, too."""
    count = 250_000
    text = "".join(f"G1 X{n}\r\n" for n in range(count))
    index, _ = index_of(tmp_path, text.encode("utf-16"))
    assert len(index) == count
    assert index[count - 1] == f"G1 X{count - 1}"
    assert index[200_000:200_002] == ["G1 X200000", "G1 X200001"]


@pytest.mark.parametrize(
    "held", [b"G0\nG1\0\n", b"a\n" + b"x" * 4097, b"\n\n" + "Ü".encode() * 4097 + b"\nb"]
)
def test_what_the_language_refuses_is_refused(tmp_path: Path, held: bytes) -> None:
    with pytest.raises(ProgramError) as refused:
        index_of(tmp_path, held)
    with pytest.raises(ProgramError) as there:
        list(read_lines(tmp_path / "part.ngc"))
    assert (refused.value.line, refused.value.message) == (there.value.line, there.value.message)


def test_what_was_opened_last_comes_first(tmp_path: Path) -> None:
    recent = RecentPrograms(tmp_path / "state")
    assert recent.paths() == []
    for name in ("a", "b", "a", "c"):
        recent.add(tmp_path / name)
    assert [path.name for path in RecentPrograms(tmp_path / "state").paths()] == ["c", "a", "b"]
    for number in range(50):
        recent.add(Path(f"/{number}"))
    assert len(recent.paths()) == 20
    assert os.stat(tmp_path / "state" / "recent.json").st_mode & 0o777 == 0o600


@pytest.mark.parametrize("held", [b"", b"{", b"7", b'["/a", 3, ""]', b"\xff", b"[" * 100_000])
def test_a_list_that_is_damaged_is_no_list(tmp_path: Path, held: bytes) -> None:
    (tmp_path / "recent.json").write_bytes(held)
    recent = RecentPrograms(tmp_path)
    assert recent.paths() in ([], [Path("/a")])
    recent.add(Path("/b"))
    assert recent.paths()[0] == Path("/b")


def test_a_link_is_not_followed(tmp_path: Path) -> None:
    (tmp_path / "other").write_text('["/a"]')
    (tmp_path / "recent.json").symlink_to(tmp_path / "other")
    recent = RecentPrograms(tmp_path)
    assert recent.paths() == []
    recent.add(Path("/b"))
    assert (tmp_path / "other").read_text() == '["/a"]'
