"""Configuration files: a machine, or one sentence."""

from pathlib import Path

from hypothesis import example, given
from hypothesis import strategies as st

from fraese.assembly import assemble
from fraese.config.file import annotated, load
from tests.fuzz.lengths import fuzzed, is_a_sentence, refusal_of

_DEFAULTS = [line.lstrip("#") for line in annotated().splitlines() if " = " in line or "[" in line]
_VALUES = st.one_of(
    st.sampled_from(
        ["0", "-1", "1e-320", "1e400", "nan", "inf", '""', '"x"', "true", "[]", "{}", "[[1]]"]
    ),
    st.sampled_from(
        ["9" * 5000, "1979-05-27", '"\u0000"', '"\u202e"', '["x", "x"]', '"/dev/zero"']
    ),
    st.integers().map(str),
    st.floats().map(str),
)


def _taken(path: Path) -> None:
    refusal = refusal_of(lambda: assemble(load(path), at_desk=True).controller.close())
    assert is_a_sentence(refusal)


def _with_value(lines: list[str], value: tuple[int, str]) -> list[str]:
    at, said = value
    key = lines[at % len(lines)].partition(" = ")[0]
    return [*lines[:at], f"{key} = {said}", *lines[at + 1 :]]


def test_values(tmp_path: Path) -> None:
    path = tmp_path / "fraese.toml"
    keyed = [place for place, line in enumerate(_DEFAULTS) if " = " in line]

    @fuzzed(80)
    @given(st.sampled_from(keyed), _VALUES)
    def check(place: int, value: str) -> None:
        lines = _with_value(_DEFAULTS, (place, value))
        path.write_text("\n".join(lines))
        _taken(path)

    check()


def test_lines(tmp_path: Path) -> None:
    path = tmp_path / "fraese.toml"
    lines = st.lists(st.sampled_from(_DEFAULTS), max_size=12).map("\n".join)

    @fuzzed(80)
    @given(lines)
    @example("x = " + "[" * 200_000)
    @example("x = " + "9" * 5000)
    def check(text: str) -> None:
        path.write_text(text)
        _taken(path)

    check()


def test_any_bytes(tmp_path: Path) -> None:
    path = tmp_path / "fraese.toml"

    @fuzzed(100)
    @given(
        st.binary(max_size=200)
        | st.text(max_size=200).map(lambda text: text.encode("utf-8", "replace"))
    )
    def check(data: bytes) -> None:
        path.write_bytes(data)
        _taken(path)

    check()
