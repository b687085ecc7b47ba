"""Programs for the judge, made by hypothesis: long, mixed, and mostly valid."""

import math
from collections.abc import Callable

from hypothesis import strategies as st

Draw = Callable[[st.SearchStrategy[str]], str]

AXES = ("x", "y", "z")
_COORDINATES = st.integers(-50_000, 50_000).map(lambda n: f"{n / 1000:.3f}")
_SMALL = st.integers(1, 5_000).map(lambda n: f"{n / 1000:.3f}")
_SIGNED = st.integers(-9, 9).filter(bool)


def _axis_words(least: int, axes: tuple[str, ...] = AXES) -> st.SearchStrategy[str]:
    return st.lists(st.sampled_from(axes), min_size=least, max_size=3, unique=True).flatmap(
        lambda axes: st.tuples(*(_COORDINATES for _ in axes)).map(
            lambda values: " ".join(f"{a}{v}" for a, v in zip(axes, values, strict=True))
        )
    )


def _expression(depth: int = 3) -> st.SearchStrategy[str]:
    leaf = st.one_of(
        st.integers(-20, 20).map(str),
        _COORDINATES,
        st.sampled_from(("#1", "#2", "#3", "#5420", "#5421", "#<_g>")),
    )
    if depth == 0:
        return leaf
    inner = _expression(depth - 1)
    operator = st.sampled_from(
        (
            "+",
            "-",
            "*",
            "/",
            " eq ",
            " ne ",
            " lt ",
            " le ",
            " gt ",
            " ge ",
            " and ",
            " or ",
            " xor ",
        )
    )
    function = st.sampled_from(("abs", "fix", "fup", "round", "sin", "cos"))
    terms = st.lists(st.tuples(operator, inner), min_size=1, max_size=3)
    return st.one_of(
        leaf,
        st.tuples(inner, terms).map(lambda t: "[" + t[0] + "".join(o + i for o, i in t[1]) + "]"),
        st.tuples(function, inner).map(lambda t: f"{t[0]}[{t[1]}]"),
        inner.map(lambda text: f"[round[{text}] mod 7]"),
        st.tuples(inner, inner).map(lambda t: f"atan[{t[0]}]/[{t[1]}]"),
    )


# Behind a probe and a tool change rs274 asks its pretended machine for the position, and that
# knows of no offset set since the last move: what follows must be absolute.
SYNC = "\ng90 g0 x1 y2 z3"
# SavedState small by cos, so that places stay where four decimals mean something.
_WORD_VALUE = _expression(2).map(lambda text: f"[20*cos[{text}]]")
STRAIGHT = st.one_of(
    st.tuples(st.sampled_from(("g0 ", "g1 ", "g1 f250 ", "")), _axis_words(1)).map("".join),
    st.tuples(st.sampled_from(("g0 ", "g1 ")), st.sampled_from(AXES), _WORD_VALUE).map("".join),
    st.tuples(st.just("g53 g0 "), _axis_words(1)).map("".join),
    st.tuples(st.just("g91 g1 "), _axis_words(1), st.just("\ng90")).map("".join),
)
MODES = st.sampled_from(
    [
        *(
            "g17",
            "g18",
            "g19",
            "g49\ng20",
            "g49\ng21",
            "g90",
            "g91",
            "g98",
            "g99",
            "g61",
            "g64",
        ),
        *("g61.1", "g93 g1 f3 x1\ng94 f200", "g94 f300", "g49\ng20 f20", "g49\ng21 f400", "g80 g0"),
        *("g90 g17 g49\ng21", "m2", "m70\ng91\nm72", "f[100+#1*0]"),
    ]
)
MACHINE = st.sampled_from(
    [
        *(
            "m3 s1000",
            "m4 s200",
            "m5",
            "s500",
            "m7",
            "m8",
            "m9",
            "t1 m6" + SYNC,
            "t2 m6" + SYNC + "\ng43",
            "m48",
        ),
        *("m49", "g4 p0.5", "m0", "m1", "(msg,here)", "(debug,#1 #2)", "(print,#5420)"),
    ]
)
OFFSETS = st.one_of(
    st.tuples(st.sampled_from(("g10 l2 p1 ", "g10 l2 p2 ", "g10 l20 p0 ", "g10 l20 p2 ")),
              _axis_words(1)).map("".join),
    st.tuples(st.sampled_from(("g92 ", "g52 ", "g43.1 ")), _axis_words(1)).map("".join),
    st.tuples(st.sampled_from(("g28 ", "g30 ")), _axis_words(0)).map("".join),
    st.sampled_from(("g54", "g55", "g59.3", "g92.1", "g92.2", "g92.3", "g43 h1", "g43 h2", "g49"))
    | st.sampled_from(("g28.1", "g30.1", "g43", "g92.1\ng10 l2 p0 r30", "g10 l2 p0 r0")),
)  # fmt: skip


def _arc(code: str, turn_deg: int, i: int, j: int, turns: int, rise: str) -> str:
    """A closed arc in incremental words: its end is its start turned about the centre."""
    angle = math.radians(turn_deg)
    x = i - i * math.cos(angle) + j * math.sin(angle)
    y = j - i * math.sin(angle) - j * math.cos(angle)
    words = f"x{x:.6f} y{y:.6f} i{i} j{j}" + (f" p{turns}" if turns > 1 else "")
    return f"g17 g91 {code} {words}{rise}\ng90"


ARCS = st.one_of(
    st.builds(
        _arc,
        st.sampled_from(("g2", "g3")),
        st.integers(1, 359),
        _SIGNED,
        _SIGNED,
        st.integers(1, 3),
        st.sampled_from(("", " z1.5", " z-2", " f120")),
    ),
    st.tuples(
        st.sampled_from(("g2 ", "g3 ")), _axis_words(2), st.sampled_from((" r700", " r-700"))
    ).map("".join),
    st.tuples(
        st.sampled_from(("g17 g2 i", "g17 g3 j", "g18 g2 k", "g18 g3 i", "g19 g3 j", "g19 g2 k")),
        _SIGNED.map(str),
    ).map("".join),
)


def _cycle(code: str, across: str, r: str, depth: str, more: str) -> str:
    needs = {"g73": " q1.3", "g83": " q0.9", "g82": " p0.25", "g86": " p0", "g89": " p1"}
    return f"g17 {code} {across} r{r} z-{depth}{needs.get(code, '')}{more}"


CYCLES = st.builds(
    _cycle,
    st.sampled_from(("g81", "g82", "g73", "g83", "g85", "g86", "g89")),
    st.tuples(_COORDINATES, _COORDINATES).map(lambda t: f"x{t[0]} y{t[1]}"),
    _SMALL,
    _SMALL,
    st.sampled_from(("", " l2", "\nx1", "\nx3 r2", "\ny1 z-6\nx0", "\ng98 x2\ng99 x3", "\ng80")),
)
PARAMETERS = st.one_of(
    st.tuples(st.sampled_from(("#1=", "#2=", "#3=", "#<_g>=")), _expression(3)).map("".join),
    st.tuples(st.just("(debug,#1 #2 #3)\n#1=[#2+1] #2="), _expression(1)).map("".join),
)
PROBES = st.tuples(
    st.sampled_from(("g94 g38.2 f50 ", "g94 g38.3 f50 ", "g94 g38.5 f50 ")),
    _axis_words(2),
    st.just(SYNC),
).map("".join)
SIMPLE = st.one_of(STRAIGHT, STRAIGHT, MODES, MACHINE, OFFSETS, ARCS, CYCLES, PARAMETERS, PROBES)
BLOCK = st.lists(SIMPLE, min_size=1, max_size=4).map("\n".join)
CONTROL = st.one_of(
    st.tuples(st.integers(0, 3), BLOCK).map(lambda t: f"o@ repeat [{t[0]}]\n{t[1]}\no@ endrepeat"),
    st.tuples(_expression(2), BLOCK, BLOCK).map(
        lambda t: f"o@ if [{t[0]}]\n{t[1]}\no@ else\n{t[2]}\no@ endif"
    ),
    BLOCK.map(lambda b: f"#9=0\no@ while [#9 lt 2]\n{b}\n#9=[#9+1]\no@ endwhile"),
    BLOCK.map(lambda b: f"#9=0\no@ do\n{b}\n#9=[#9+1]\no@ while [#9 lt 2]"),
    st.tuples(_expression(1), BLOCK).map(
        lambda t: f"o@ sub\n{t[1]}\n#1=[#1+#2]\no@ endsub [#1]\no@ call [{t[0]}] [3]\no@ call"
    ),
)


def _program(parts: list[str]) -> str:
    """Put the parts together; every O-word gets a number of its own."""
    numbered = [part.replace("o@", f"o{100 + index}") for index, part in enumerate(parts)]
    return "\n".join(("#<_g>=1", "f100 g0 x0 y0 z0", *numbered, "m2", ""))


PROGRAMS = st.lists(st.one_of(SIMPLE, SIMPLE, SIMPLE, CONTROL), min_size=3, max_size=25).map(
    _program
)
# The same with a rotary axis among the words; G2 and the cycles have examples of their own.
_WITH_A = (*AXES, "a")
_ROTARY_SYNC = SYNC + " a4"
ROTARY = st.one_of(
    st.tuples(
        st.sampled_from(("g0 ", "g1 ", "g1 f250 ", "")), _axis_words(1, _WITH_A)
    ).map("".join),
    st.tuples(st.sampled_from(("g0 a", "g1 a", "g1 f40 a", "g93 g1 f2 a")), _COORDINATES).map(
        lambda t: "".join(t) + ("\ng94 f200" if "g93" in t[0] else "")
    ),
    st.tuples(st.just("g91 g1 "), _axis_words(1, _WITH_A), st.just("\ng90")).map("".join),
    st.tuples(st.just("g53 g0 "), _axis_words(1, _WITH_A)).map("".join),
    st.tuples(st.sampled_from(("g10 l2 p1 ", "g10 l2 p2 ", "g10 l20 p0 ", "g10 l20 p2 ", "g92 ",
              "g52 ")), _axis_words(1, _WITH_A)).map("".join),
    st.tuples(st.sampled_from(("g28 ", "g30 ")), _axis_words(0, _WITH_A)).map("".join),
    st.tuples(st.sampled_from(("g17 g2 i3 a", "g17 g3 j-2 f120 a", "g18 g2 k2 a")),
              _COORDINATES).map("".join),
    st.tuples(
        st.just("g94 g38.3 f50 "), _axis_words(2, _WITH_A), st.just(_ROTARY_SYNC)
    ).map("".join),
    st.just("(debug,#5423 #<_a> #<_abs_a> #5214 #5224)"),
)  # fmt: skip
ROTARY_PROGRAMS = st.lists(st.one_of(SIMPLE, ROTARY, ROTARY), min_size=3, max_size=25).map(_program)
EXPRESSIONS = st.lists(_expression(3), min_size=1, max_size=12).map(
    lambda values: "\n".join(
        (
            "#1=2 #2=-3.5 #3=7 #<_g>=1",
            *(f"#1=[{value}]\n(debug,%.4f#1)\ng0 x[20*cos[#1]]" for value in values),
            "m2",
            "",
        )
    )
)
