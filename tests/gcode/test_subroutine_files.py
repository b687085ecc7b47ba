from pathlib import Path

import pytest

from fraese.errors import ProgramError
from fraese.gcode.canon import Rapid
from tests.gcode.run import moves


def test_a_subroutine_may_be_a_file(tmp_path: Path) -> None:
    (tmp_path / "hole.ngc").write_text(
        "(a hole)\no<hole> sub\ng0 x#1\no<deeper> call [7]\no<hole> endsub\n"
        "o<deeper> sub\ng0 y#1\no<deeper> endsub\nm2\n",
        encoding="utf-8",
    )
    result = moves("o<HOLE> call [3] | g0 z1", folders=(tmp_path,))
    assert result[:3] == [Rapid(3, (3, 0, 0)), Rapid(7, (3, 7, 0)), Rapid(2, (3, 7, 1))]


def test_errors_in_a_file_name_it(tmp_path: Path) -> None:
    (tmp_path / "bad.ngc").write_text("o<bad> sub\ng0 x[1/0]\no<bad> endsub\n", encoding="utf-8")
    with pytest.raises(
        ProgramError, match=r"bad\.ngc, line 2 \(called in part\.ngc, line 1\): division by zero"
    ):
        moves("o<bad> call", folders=(tmp_path,), file="part.ngc")


@pytest.mark.parametrize("name", ["../bad", "/etc/passwd", "none"])
def test_only_plain_names_in_the_folder(tmp_path: Path, name: str) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / "bad.ngc").write_text(f"o<{name}> sub\no<{name}> endsub\n", encoding="utf-8")
    with pytest.raises(ProgramError, match="no such subroutine"):
        moves(f"o<{name}> call", folders=(tmp_path / "in",))


def test_a_file_without_its_subroutine_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.ngc").write_text("g0 x1\n", encoding="utf-8")
    with pytest.raises(ProgramError, match="holds no o<a> sub"):
        moves("o<a> call", folders=(tmp_path,))


def test_folders_are_searched_in_order(tmp_path: Path) -> None:
    first, second = tmp_path / "own", tmp_path / "shared"
    for folder, places in ((first, {"a": 1}), (second, {"a": 9, "b": 2})):
        folder.mkdir()
        for name, place in places.items():
            text = f"o<{name}> sub\ng0 x{place}\no<{name}> endsub\n"
            (folder / f"{name}.ngc").write_text(text, encoding="utf-8")
    result = moves("o<a> call | o<b> call", folders=(first, second))
    assert result[:2] == [Rapid(2, (1, 0, 0)), Rapid(2, (2, 0, 0))]


def test_no_link_leads_out_of_a_folder(tmp_path: Path) -> None:
    folder = tmp_path / "in"
    folder.mkdir()
    for place in (tmp_path / "a.ngc", folder / "real.ngc"):
        place.write_text("o<a> sub\ng0 x1\no<a> endsub\no<b> sub\ng0 x2\no<b> endsub\n", "utf-8")
    (folder / "a.ngc").symlink_to(tmp_path / "a.ngc")
    (folder / "b.ngc").symlink_to(folder / "real.ngc")
    with pytest.raises(
        ProgramError, match=r"a\.ngc \(called in line 1\): is a link that leads out"
    ):
        moves("o<a> call", folders=(folder,))
    assert moves("o<b> call", folders=(folder,))[0] == Rapid(5, (2, 0, 0))
