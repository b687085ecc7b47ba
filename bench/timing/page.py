"""The measured part of docs/timing.md: written between two marks, with its pictures beside it."""

from collections.abc import Sequence
from pathlib import Path

from bench.timing.figures import Section
from bench.timing.picture import svg

DOCS = Path(__file__).parents[2] / "docs"
PAGE = DOCS / "timing.md"
_BEGIN = "<!-- measured: begin; written by python -m bench.timing --all -->"
_END = "<!-- measured: end -->"


def markdown(sections: Sequence[Section], conditions: str) -> str:
    """The measured part."""
    lines = [conditions, ""]
    for section in sections:
        lines += [f"### {section.title}", ""]
        if section.rows:
            lines += [*section.table(), "", f"![{section.title}]({_picture(section)})", ""]
        for sentence in section.said:
            lines += [f"- {sentence}"]
        lines += [f"- Load average before and after: {section.load}.", ""]
    return "\n".join(lines)


def write(sections: Sequence[Section], conditions: str) -> list[Path]:
    """Put it into the page, and the pictures beside it."""
    text = PAGE.read_text("utf-8")
    before, _, rest = text.partition(_BEGIN)
    _, mark, after = rest.partition(_END)
    assert mark, f"{PAGE} has no place for what was measured"
    PAGE.write_text(f"{before}{_BEGIN}\n\n{markdown(sections, conditions)}\n{_END}{after}", "utf-8")
    pictures = [section for section in sections if section.rows]
    for section in pictures:
        (DOCS / _picture(section)).write_text(svg(section), "utf-8")
    return [PAGE, *(DOCS / _picture(section) for section in pictures)]


def _picture(section: Section) -> str:
    return f"timing-{section.key}.svg"
