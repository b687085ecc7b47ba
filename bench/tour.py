"""The pictures of docs/app.md, drawn by the app itself, on the simulated mill in virtual time.

Run: python -m bench.tour [LANGUAGE]; without one, in all.

What has not changed is drawn byte by byte as before, so that git shows what has.
"""

import asyncio
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from fraese.phrases import speak

_DOCS = Path(__file__).parents[1] / "docs"
PICTURES = _DOCS / "tour"
#: What is drawn in which language is what its page shows.
TOURS = {"en": _DOCS / "app.md", "de": _DOCS / "app.de.md"}
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


def named(language: str) -> set[str]:
    """Pictures that the tour shows."""
    return set(re.findall(rf"tour/{language}/([\w-]+)\.svg", TOURS[language].read_text("utf-8")))


async def draw(folder: Path, wanted: set[str]) -> None:
    """These stops of the walk."""
    from tests.ui.walk import app_on_the_way, walk, without_time

    with tempfile.TemporaryDirectory() as place:
        async with app_on_the_way(Path(place), SIZE) as b:
            async for stop in walk(b):
                if stop.name not in wanted:
                    continue
                picture = slim(without_time(b.app.export_screenshot()))
                file = folder / f"{stop.name}.svg"
                file.write_text(picture, "utf-8")
                print(f"{file}  {len(picture) // 1000} kB")


def main(language: str = "") -> None:
    """Draw the tour; an app has one language, so each has a process of its own."""
    if not language:
        for each in TOURS:
            subprocess.run([sys.executable, "-m", "bench.tour", each], check=True)
        return
    # Before anything else of ours: words are chosen when modules are loaded.
    speak(language)
    folder = PICTURES / language
    folder.mkdir(parents=True, exist_ok=True)
    asyncio.run(draw(folder, named(language)))


if __name__ == "__main__":
    main(*sys.argv[1:])
