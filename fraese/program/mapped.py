"""The height map of a program: its file, read once like the program itself."""

from dataclasses import dataclass
from pathlib import Path

from fraese.errors import ProgramError
from fraese.heightmap.heights import HeightMap
from fraese.heightmap.mapfile import MOST_BYTES, PartMap, decoded
from fraese.phrases import phrase
from fraese.program.content import Content, is_still, take
from fraese.program.context import ProgramContext


@dataclass(frozen=True)
class TakenMap:
    """A map as it was when it was chosen.

    Attributes:
        path: where it was.
        content: what the file held.
        heights: what that means.
    """

    path: Path
    content: Content
    heights: HeightMap

    @property
    def name(self) -> str:
        """For people."""
        return self.path.name

    def in_short(self) -> str:
        """Its name, and where Z0 belongs."""
        return phrase(
            "{name}, Z0 at {reference}", name=self.name, reference=self.heights.reference_in_words()
        )

    def news(self) -> str:
        """What became of the file since, a sentence; empty: it holds what it did."""
        still = is_still(self.path, self.content)
        if still is None:
            return phrase("{name} is gone from where it was opened.", name=self.name)
        return (
            ""
            if still
            else phrase("{name} has changed on disk since it was opened.", name=self.name)
        )


def about_map(taken: TakenMap, context: ProgramContext) -> list[str]:
    """What a person should know who runs a program with it, sentences."""
    moved = taken.heights.moved(context.parameters, "".join(context.machine.names))
    return [said_of(taken), moved] if moved else [said_of(taken)]


def said_of(taken: TakenMap) -> str:
    """What it is, and where Z0 belongs, a sentence."""
    heights = taken.heights
    return phrase(
        "Height map {name}: {in_words}; Z0 belongs on the work at {reference} of {system}.",
        name=taken.name,
        in_words=heights.in_words(),
        reference=heights.reference_in_words(),
        system=heights.system_name,
    )


def heights_of(taken: TakenMap | None) -> HeightMap | None:
    """What it means; None: there is none."""
    return None if taken is None else taken.heights


def take_map(path: Path) -> TakenMap:
    """Read a height map, once.

    Raises:
        ProgramError: there is none, it is none, or it is not probed to its end.
    """
    content = take(path)
    if content is None:
        raise ProgramError(phrase("there is no such file."), file=str(path))
    return map_of(path, content)


def map_of(path: Path, content: Content) -> TakenMap:
    """The map that a file held.

    Raises:
        ProgramError: it holds none, or one that is not probed to its end.
    """
    part = part_of(content)
    if part.missing:
        raise ProgramError(
            phrase(
                "is not probed to its end: {missing} of {points} points are missing; go on with"
                " fraese probe-map --go-on.",
                missing=part.missing,
                points=part.points,
            ),
            file=content.file,
        )
    return TakenMap(path, content, part.whole())


def part_of(content: Content) -> PartMap:
    """The map that a file held, as far as it is probed.

    Raises:
        ProgramError: it holds none.
    """
    if content.size > MOST_BYTES:
        raise ProgramError(phrase("is no height map: it is too large."), file=content.file)
    with content.open() as stream:
        raw = stream.read()
    try:
        # Some editors put a mark in front.
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ProgramError(phrase("is no height map: it is no text."), file=content.file) from error
    return decoded(text, content.file)
