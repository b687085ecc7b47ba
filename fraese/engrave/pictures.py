"""Pictures of dots, read by Pillow.

Rule 1: what is transparent is white, what is coloured is as dark as it looks.
Rule 2: a picture is made as small as it is needed before anything else is done with it.
"""

import io
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageOps

from fraese.errors import FraeseError, UsageError
from fraese.phrases import phrase
from fraese.plaintext import plain

#: Kinds that Pillow is asked for: others run programs, or take anything for theirs. MPO is a JPEG.
_FORMATS: Final = ("PNG", "JPEG", "GIF", "TIFF", "BMP", "WEBP", "PPM", "DIB")
#: Modes with more than 8 bits, and what is white in them.
_DEEP: Final = {"I;16": 65535.0, "I;16B": 65535.0, "I;16L": 65535.0, "I": 65535.0, "F": 1.0}
#: Where a picture says which side is up; from 5 on it lies on its side.
_TURNED: Final = 0x0112
#: Memory that a picture may take is bounded by its dots.
MOST_DOTS: Final = 80_000_000


class DotPicture:
    """A picture in memory; see ``drawing.Picture``.

    Args:
        data: what is in the file.
        name: of the file.

    Raises:
        UsageError: if Pillow cannot read it.
    """

    def __init__(self, data: bytes, name: str) -> None:
        self._data, self._name = data, name
        self.notes: list[str] = []
        with _refusals(name), self._opened() as picture:
            columns, rows = picture.size
            if columns * rows > MOST_DOTS:
                raise UsageError(
                    phrase(
                        "{name} has {columns} x {rows} dots; up to {most:g} million are read.",
                        name=name,
                        columns=columns,
                        rows=rows,
                        most=MOST_DOTS / 1e6,
                    )
                )
            frames = getattr(picture, "n_frames", 1)
            turned = _may_be_turned(picture) and picture.getexif().get(_TURNED, 1) >= 5
        self.columns, self.rows = (rows, columns) if turned else (columns, rows)
        if frames > 1:
            self.notes.append(
                phrase(
                    "{name} has {frames} pictures; the first is taken.", name=name, frames=frames
                )
            )

    def darkness(self, columns: int, rows: int) -> NDArray[np.uint8]:
        """See ``drawing.Picture``."""
        with _refusals(self._name), self._opened() as picture:
            if picture.format == "JPEG":
                # Decoded smaller where it may be; no smaller than this.
                side = max(columns, rows)
                picture.draft("L", (side, side))
            if _may_be_turned(picture):
                ImageOps.exif_transpose(picture, in_place=True)
            small = _grey(picture).resize((columns, rows), Image.Resampling.BOX)
            return 255 - np.asarray(small, np.uint8)

    def _opened(self) -> Image.Image:
        return Image.open(io.BytesIO(self._data), formats=_FORMATS)


def read(data: bytes, name: str) -> DotPicture:
    """A picture.

    Raises:
        UsageError: if it cannot be read.
    """
    return DotPicture(data, name)


def _may_be_turned(picture: Image.Image) -> bool:
    """It may say which side is up. In a PNG that would be asked by reading all of it."""
    return picture.format in ("JPEG", "MPO", "TIFF", "WEBP")


def _grey(picture: Image.Image) -> Image.Image:
    """How bright it is, 8 bits, on white."""
    if picture.mode in _DEEP:
        values = np.asarray(picture, np.float32)
        white = max(_DEEP[picture.mode], float(values.max()) if picture.mode == "F" else 0.0)
        return Image.fromarray((values.clip(0, white) * (255 / white)).astype(np.uint8))
    if picture.has_transparency_data:
        clear = picture.convert("RGBA")
        grey = Image.new("L", picture.size, 255)
        grey.paste(clear.convert("L"), mask=clear.getchannel("A"))
        return grey
    return picture.convert("L")


@contextmanager
def _refusals(name: str) -> Iterator[None]:
    """Whatever Pillow raises is one sentence: of broken files it raises nearly anything."""
    limit = Image.MAX_IMAGE_PIXELS
    try:
        # Its own limit warns of what is still read here.
        Image.MAX_IMAGE_PIXELS = MOST_DOTS
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    except FraeseError:
        raise
    except Image.DecompressionBombError as error:
        raise UsageError(
            phrase(
                "{name} has too many dots; up to {most:g} million are read.",
                name=name,
                most=MOST_DOTS / 1e6,
            )
        ) from error
    except Exception as error:
        raise UsageError(
            phrase("{name} cannot be read as a picture: {why}.", name=name, why=_why(error))
        ) from error
    finally:
        Image.MAX_IMAGE_PIXELS = limit


def _why(error: Exception) -> str:
    said = plain(str(error)).strip().rstrip(".")
    return said if said and "BytesIO" not in said else phrase("it is broken")


def dithered(darkness: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Dots, 0 or 1, as dense as it is dark: what is too much at one goes to its neighbours.

    Floyd and Steinberg, by Pillow.
    """
    picture = Image.fromarray(255 - darkness).convert("1", dither=Image.Dither.FLOYDSTEINBERG)
    return (~np.asarray(picture)).astype(np.uint8)
