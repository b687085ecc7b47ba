import codecs
from pathlib import Path

import pytest

from fraese.errors import ProgramError
from fraese.gcode.text import MAX_LINE, read_lines


def lines(tmp_path: Path, data: bytes) -> list[str]:
    path = tmp_path / "part.ngc"
    path.write_bytes(data)
    return [line.rstrip("\r") for line in read_lines(path)]


@pytest.mark.parametrize(
    "data",
    [
        "g0\n(Fräser)\ng1".encode(),
        "g0\r\n(Fräser)\r\ng1".encode(),
        "g0\r(Fräser)\rg1".encode(),
        "g0\n(Fräser)\ng1".encode("latin-1"),
        codecs.BOM_UTF8 + "g0\n(Fräser)\ng1".encode(),
        codecs.BOM_UTF16_LE + "g0\n(Fräser)\ng1".encode("utf-16-le"),
        codecs.BOM_UTF16_BE + "g0\r\n(Fräser)\r\ng1".encode("utf-16-be"),
    ],
)
def test_any_encoding_and_line_end(tmp_path: Path, data: bytes) -> None:
    assert lines(tmp_path, data) == ["g0", "(Fräser)", "g1"]


@pytest.mark.parametrize("encoding", ["utf-8", "latin-1", "utf-16"])
def test_no_line_is_lost_between_chunks(tmp_path: Path, encoding: str) -> None:
    wanted = [f"g1 x{i} (ä{'ö' * (i % 50)})" for i in range(20_000)]
    assert lines(tmp_path, "\n".join(wanted).encode(encoding)) == wanted


def test_empty(tmp_path: Path) -> None:
    assert lines(tmp_path, b"") == []
    assert lines(tmp_path, b"\n\n") == ["", ""]


@pytest.mark.parametrize("data", [b"g0 x1\ng1\0x", b"\x7fELF\0\0", b"g0\n" + b"\0" * 100_000])
def test_binary_is_refused(tmp_path: Path, data: bytes) -> None:
    with pytest.raises(ProgramError, match="binary"):
        lines(tmp_path, data)


def test_an_endless_line_is_refused_early(tmp_path: Path) -> None:
    with pytest.raises(ProgramError, match=f"line 2: .* longer than {MAX_LINE}"):
        lines(tmp_path, b"g0\n" + b"x" * 5_000_000)


def test_a_missing_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ProgramError, match=r"nothing\.ngc: there is no such file"):
        list(read_lines(tmp_path / "nothing.ngc"))
