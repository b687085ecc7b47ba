"""The pictures of docs/app.md, drawn by the app itself, on the simulated mill in virtual time.

Run: python -m bench.tour [LANGUAGE]

What has not changed is drawn byte by byte as before, so that git shows what has.
"""

import asyncio
import os
import re
import sys
import tempfile
from pathlib import Path

_DOCS = Path(__file__).parents[1] / "docs"
TOUR, PICTURES = _DOCS / "app.md", _DOCS / "tour"
SIZE = (100, 32)
#: Letters as wide as the grid; Rich names one that would have to be fetched.
_FONT = "ui-monospace, Menlo, Consolas, DejaVu Sans Mono, monospace"


def slim(svg: str) -> str:
    """A picture without what nobody sees: fonts to be fetched, frames of lines, long names."""
    svg = re.sub(r"@font-face \{.*?\}\s*", "", svg, flags=re.DOTALL)
    svg = re.sub(r"<!--.*?-->\s*", "", svg, flags=re.DOTALL)
    svg = re.sub(r"<clipPath id=\"[\w-]+-line-\d+\">.*?</clipPath>\s*", "", svg, flags=re.DOTALL)
    svg = re.sub(r" clip-path=\"url\(#[\w-]+-line-\d+\)\"", "", svg)
    svg = re.sub(r"terminal-\d+-", "t", svg)
    svg = re.sub(r' shape-rendering="crispEdges"', "", svg).replace(
        "<g ", '<g shape-rendering="crispEdges" ', 1
    )
    return re.sub(r"\n\s*", "\n", svg.replace("Fira Code, monospace", _FONT))


def named() -> set[str]:
    """Pictures that the tour shows."""
    return set(re.findall(r"tour/en/([\w-]+)\.svg", TOUR.read_text("utf-8")))


async def draw(folder: Path) -> None:
    """Those stops of the walk that the tour shows."""
    from tests.ui.walk import app_on_the_way, walk, without_time

    wanted = named()
    with tempfile.TemporaryDirectory() as place:
        async with app_on_the_way(Path(place), SIZE) as b:
            async for stop in walk(b):
                if stop.name not in wanted:
                    continue
                picture = slim(without_time(b.app.export_screenshot()))
                file = folder / f"{stop.name}.svg"
                file.write_text(picture, "utf-8")
                print(f"{file}  {len(picture) // 1000} kB")


def main(language: str = "en") -> None:
    os.environ["FRAESE_LANGUAGE"] = language
    folder = PICTURES / language
    folder.mkdir(parents=True, exist_ok=True)
    asyncio.run(draw(folder))


if __name__ == "__main__":
    main(*sys.argv[1:])
