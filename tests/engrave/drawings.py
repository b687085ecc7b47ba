"""Small files of every kind: the same rectangle of 30 x 20 mm with a circle of radius 4 in it."""

import io

import numpy as np
from PIL import Image

from fraese.engrave.nofonts import no_fonts
from tests.engrave.bench import SQUARE_HPGL, SQUARE_SVG

with no_fonts():
    from ezdxf.document import Drawing
    from ezdxf.filemanagement import new


def dxf(unit: int = 4) -> Drawing:
    """An empty drawing."""
    document = new()
    document.header["$INSUNITS"] = unit
    return document


def written(document: Drawing, *, binary: bool = False) -> bytes:
    if binary:
        stream = io.BytesIO()
        document.write(stream, fmt="bin")
        return stream.getvalue()
    text = io.StringIO()
    document.write(text)
    return text.getvalue().encode()


def square_dxf(*, binary: bool = False) -> bytes:
    """Of loose lines, in both directions."""
    document = dxf()
    space = document.modelspace()
    corners = [(0, 0), (30, 0), (30, 20), (0, 20)]
    for number in range(4):
        ends = corners[number], corners[(number + 1) % 4]
        space.add_line(*(ends if number % 2 else ends[::-1]))
    space.add_circle((15, 15), 4)
    return written(document, binary=binary)


def png(darkness: np.ndarray, **options: object) -> bytes:
    stream = io.BytesIO()
    Image.fromarray(255 - darkness.astype(np.uint8)).save(stream, "PNG", **options)
    return stream.getvalue()


def square_png() -> bytes:
    """A dark rectangle of 300 x 200 dots with a white hole."""
    darkness = np.zeros((220, 320), np.uint8)
    darkness[10:210, 10:310] = 255
    rows, columns = np.mgrid[:220, :320]
    darkness[(rows - 60) ** 2 + (columns - 160) ** 2 < 40**2] = 0
    return png(darkness)


EVERY = {
    "square.svg": SQUARE_SVG.encode(),
    "square.plt": SQUARE_HPGL.encode(),
    "square.dxf": square_dxf(),
    "binary.dxf": square_dxf(binary=True),
    "square.png": square_png(),
}
