"""The app in German, in a process of its own: its words are chosen when it is loaded.

Prints what each picture shows in English: sentences of the catalogue that are not in German there.
"""

import json
import re
import sys

from fraese.phrases import read_catalogue, speak

speak("de")

from tests.ui.helpers import Bench, bench, play  # noqa: E402

_CATALOGUE = read_catalogue("de")
#: Short words may be parts of German ones.
_ENGLISH = [
    said
    for said, ours in _CATALOGUE.items()
    if said != ours and re.fullmatch(r"[A-Za-z ,;:.']{7,}", said) and said not in ours
]


def shown(b: Bench) -> str:
    """All that is drawn, line for line."""
    lines = b.app.screen._compositor.render_strips()
    return "\n".join("".join(segment.text for segment in strip) for strip in lines)


def main() -> None:
    """View after view, dialog after dialog."""
    found: dict[str, list[str]] = {}

    async def look(b: Bench, name: str) -> None:
        await b.settled()
        text = shown(b)
        found[name] = [said for said in _ENGLISH if re.search(rf"\b{re.escape(said)}", text)]

    async def scene() -> None:
        size = (int(sys.argv[1]), int(sys.argv[2]))
        async with bench(size=size) as b:
            await look(b, "start")
            for view in ("program", "calibrate", "bench", "log", "settings", "move"):
                await b.show_view(view)
                await look(b, view)
            for key in ("r", "g", "m", "n", "w", "p", "o", "e", "i", "question_mark"):
                await b.press(key)
                await look(b, key)
                await b.press("escape")
                await b.settled()
            await b.press("right")
            await look(b, "jogged")

    play(scene)
    sys.stdout.write(json.dumps(found))


if __name__ == "__main__":
    main()
