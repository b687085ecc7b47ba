"""Pictures of every sort; how dark they are; what is refused, and how much memory it takes."""

import io
import math
import struct
import tracemalloc
import zlib

import numpy as np
import pytest
from PIL import Image

from fraese.engrave.pictures import MOST_DOTS, read
from fraese.errors import UsageError
from tests.engrave.bench import Bench
from tests.engrave.drawings import EVERY, png, square_png


def saved(picture: Image.Image, kind: str = "PNG", **options: object) -> bytes:
    stream = io.BytesIO()
    picture.save(stream, kind, **options)
    return stream.getvalue()


def halves(mode: str, dark: object, bright: object) -> Image.Image:
    """The left half dark, the right one bright."""
    made = Image.new(mode, (40, 20), bright)  # type: ignore[arg-type]
    made.paste(dark, (0, 0, 20, 20))  # type: ignore[arg-type]
    return made


@pytest.mark.parametrize(
    ("picture", "kind"),
    [
        (halves("L", 0, 255), "PNG"),
        (halves("L", 0, 255), "BMP"),
        (halves("L", 0, 255), "TIFF"),
        (halves("L", 0, 255), "GIF"),
        (halves("L", 0, 255), "PPM"),
        (halves("RGB", (0, 0, 0), (255, 255, 255)), "WEBP"),
        (halves("RGB", (0, 0, 0), (255, 255, 255)), "JPEG"),
        (halves("1", 0, 1), "PNG"),
        (halves("P", 0, 1), "PNG"),
        (halves("LA", (0, 255), (0, 0)), "PNG"),
        (halves("RGBA", (0, 0, 0, 255), (0, 0, 0, 0)), "PNG"),
        (halves("I;16", 0, 65535), "PNG"),
        (halves("F", 0.0, 1.0), "TIFF"),
        (halves("CMYK", (0, 0, 0, 255), (0, 0, 0, 0)), "JPEG"),
    ],
)
def test_every_sort_is_as_dark_as_it_looks(picture: Image.Image, kind: str) -> None:
    if picture.mode == "P":
        picture.putpalette([0, 0, 0, 255, 255, 255])
    options = {"lossless": True} if kind == "WEBP" else {}
    found = read(saved(picture, kind, **options), "a").darkness(4, 2)
    assert found[:, 0].tolist() == pytest.approx([255, 255], abs=3)
    assert found[:, 3].tolist() == pytest.approx([0, 0], abs=3)


def test_a_photo_that_was_turned_is_upright() -> None:
    turned = halves("L", 0, 255)
    exif = turned.getexif()
    exif[0x0112] = 6
    found = read(saved(turned, "JPEG", exif=exif), "a.jpg")
    assert (found.columns, found.rows) == (20, 40)
    dark = found.darkness(2, 4)
    assert dark[0].tolist() == pytest.approx([255, 255], abs=9)
    assert dark[3].tolist() == pytest.approx([0, 0], abs=9)


def test_of_several_pictures_the_first_is_taken_and_that_is_told() -> None:
    frames = [halves("L", 0, 255), halves("L", 255, 0)]
    found = read(saved(frames[0], "GIF", save_all=True, append_images=frames[1:]), "a.gif")
    assert found.notes == ["a.gif has 2 pictures; the first is taken."]
    assert found.darkness(2, 1).tolist() == [[255, 0]]


def bomb(side: int) -> bytes:
    """A PNG that says it is so large, of some bytes."""
    head = struct.pack(">IIBBBBB", side, side, 8, 0, 0, 0, 0)
    chunks = [(b"IHDR", head), (b"IDAT", zlib.compress(b"\0" * 100)), (b"IEND", b"")]
    body = b"".join(
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        for kind, data in chunks
    )
    return b"\x89PNG\r\n\x1a\n" + body


@pytest.mark.parametrize("side", [9_500, 60_000])
def test_pictures_that_are_too_large_are_refused_before_they_are_read(side: int) -> None:
    assert side * side > MOST_DOTS
    tracemalloc.start()
    with pytest.raises(UsageError, match="million"):
        read(bomb(side), "a.png").darkness(10, 10)
    assert tracemalloc.get_traced_memory()[1] < 5_000_000
    tracemalloc.stop()


@pytest.mark.parametrize("share", [0.1, 0.5, 0.95])
def test_a_picture_that_ends_too_early_is_refused(share: float) -> None:
    noise = np.random.default_rng(3).integers(0, 255, (80, 80))
    whole = png(noise)
    with pytest.raises(UsageError, match=r"a\.png cannot be read as a picture"):
        read(whole[: int(len(whole) * share)], "a.png").darkness(4, 4)


def test_more_dots_than_a_machine_could_make_are_refused(bench: Bench) -> None:
    file = bench.file("a.png", square_png())
    words = [
        file,
        "-o",
        "x.ngc",
        "--way",
        "bitmap",
        "--power",
        5,
        "--width",
        1000,
        "--distance",
        0.05,
    ]
    assert "--distance" in bench.refused(*words)


def test_thresholds_and_the_bright_side(bench: Bench) -> None:
    darkness = np.zeros((60, 60), np.uint8)
    darkness[10:50, 10:50] = 100
    file = bench.file("grey.png", png(darkness))
    assert "Nothing of" in bench.refused(file, "-o", "x.ngc")
    made = bench.engrave(file, "--threshold", 20, "--width", 30)
    assert made["cut_mm"] == pytest.approx(80, rel=0.03)
    made = bench.engrave(file, "--threshold", 80, "--width", 30, "--invert")
    assert made["cut_mm"] == pytest.approx(120 + 80, rel=0.03)


def test_a_picture_has_a_size_that_is_told(bench: Bench) -> None:
    made = bench.engrave(bench.file("a.png", square_png()))
    assert made["size_mm"] == [50, pytest.approx(34.375)]
    assert "50 mm wide" in made["notes"][0]
    made = bench.engrave(bench.file("a.png", square_png()), "--height", 11, "--origin", "centre")
    assert (made["size_mm"], made["low_mm"]) == ([16, 11], [-8, -5.5])
    assert "no zero of its own" in bench.refused("a.png", "-o", "x.ngc", "--origin", "file")


@pytest.mark.parametrize("name", [name for name in EVERY if not name.endswith("png")])
def test_drawings_are_filled_in_as_bitmaps(bench: Bench, name: str) -> None:
    words = ["--way", "bitmap", "--power", 500, "--distance", 0.25, "--width", 30]
    bench.engrave(bench.file(name, EVERY[name]), *words)
    lit = [way for way in bench.ways() if way.power]
    area = sum(way.length_mm for way in lit) * 0.25
    assert area == pytest.approx(30 * 20 - 16 * math.pi, rel=0.01)
    # The hole is where the drawing has it, the right way up: a row through its middle is broken.
    middle = {"square.plt": 10}.get(name, 15 if name.endswith("dxf") else 5 + 10)
    row = [way for way in lit if abs(way.begin[1] - middle) < 0.13]
    assert sum(way.length_mm for way in row) / len({w.begin[1] for w in row}) == pytest.approx(
        22, abs=0.3
    )


def test_open_lines_are_one_dot_wide_in_bitmaps(bench: Bench) -> None:
    lines = '<path d="M0 0 H10 M5 2 V8" fill="none" stroke="black"/></svg>'
    size = 'width="20mm" height="20mm" viewBox="0 0 20 20"'
    svg = f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{lines}'
    file = bench.file("a.svg", svg)
    bench.engrave(file, "--way", "bitmap", "--power", 500, "--distance", 0.5)
    lit = [way for way in bench.ways() if way.power]
    assert {round(way.length_mm, 1) for way in lit} >= {0.5}
    assert sum(way.length_mm for way in lit) * 0.5 == pytest.approx(16 * 0.5, abs=2)
    # On a filled rectangle it is seen too.
    svg = svg.replace("<path", '<rect width="10" height="10"/><path').replace("H10", "M0 5 H10")
    bench.engrave(bench.file("c.svg", svg), "--way", "bitmap", "--power", 500, "--distance", 0.5)
    burnt = sum(way.length_mm for way in bench.ways() if way.power) * 0.5
    assert burnt == pytest.approx(100 - 16 * 0.5, abs=2)
    bench.engrave(bench.file("b.plt", "IN;PU0,0;PD0,800;"), "--way", "bitmap", "--distance", 1)
    assert len({w.end for w in bench.ways() if w.end[2] < 0}) == pytest.approx(20, abs=1)
