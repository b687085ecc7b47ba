"""Values: numbers, parameters, functions, and bracketed expressions.

Works on text without blanks and in lower case. A reader sits at a place in the text; every
method starts there and leaves it behind what it has read. Binary operators bind in five
levels, all of them from left to right::

    **    * / mod    + -    eq ne gt ge lt le    and or xor
"""

import math
import re
from collections.abc import Callable
from typing import Final

from fraese.errors import ProgramError
from fraese.gcode.parameters import MAX_INDEX, Parameters
from fraese.phrases import phrase

MAX_DEPTH: Final = 60
# Far beyond any machine, and far from where squares overflow.
MAX_VALUE: Final = 1e40
# How far from a whole number an index or a count may be.
WHOLE: Final = 1e-4
EQUAL: Final = 1e-4

# What a line that is right never shows is made once.
_EXPRESSION: Final = phrase("the expression")
_INDEX: Final = phrase("the number of a parameter")

_NUMBER = re.compile(r"[0-9.]+")
_NAME = re.compile(r"<([^<>]*)>")
_OPERATOR = re.compile(r"\*\*|[-+*/]|mod|and|xor|or|eq|ne|gt|ge|lt|le")
_FUNCTION = re.compile(r"atan|abs|acos|asin|cos|exp|fix|fup|ln|round|sin|sqrt|tan|exists")


def _divide(a: float, b: float) -> float:
    if b == 0:
        raise ProgramError(phrase("division by zero"))
    return a / b


def _power(a: float, b: float) -> float:
    if a < 0 and b != math.floor(b):
        raise ProgramError(phrase("a negative number cannot be raised to a broken power"))
    if a == 0 and b < 0:
        raise ProgramError(phrase("division by zero: zero cannot be raised to a negative power"))
    return float(a**b)


def _modulo(a: float, b: float) -> float:
    if b == 0:
        raise ProgramError(phrase("division by zero in MOD"))
    # Adding nothing makes -0 a plain 0.
    rest = math.fmod(a, b) + 0.0
    return rest + abs(b) if rest < 0 else rest


Binary = Callable[[float, float], float]
OPERATORS: Final[dict[str, tuple[int, Binary]]] = {
    "**": (5, _power),
    "*": (4, lambda a, b: a * b),
    "/": (4, _divide),
    "mod": (4, _modulo),
    "+": (3, lambda a, b: a + b),
    "-": (3, lambda a, b: a - b),
    "eq": (2, lambda a, b: float(abs(a - b) < EQUAL)),
    "ne": (2, lambda a, b: float(abs(a - b) >= EQUAL)),
    "gt": (2, lambda a, b: float(a > b)),
    "ge": (2, lambda a, b: float(a >= b)),
    "lt": (2, lambda a, b: float(a < b)),
    "le": (2, lambda a, b: float(a <= b)),
    "and": (1, lambda a, b: float(a != 0 and b != 0)),
    "or": (1, lambda a, b: float(a != 0 or b != 0)),
    "xor": (1, lambda a, b: float((a != 0) != (b != 0))),
}


def _domain(function: Binary | Callable[[float], float], said: str) -> Callable[[float], float]:
    def guarded(a: float) -> float:
        try:
            return function(a)  # type: ignore[call-arg]
        except ValueError:
            raise ProgramError(phrase("{said} of {a:g} does not exist", said=said, a=a)) from None

    return guarded


FUNCTIONS: Final[dict[str, Callable[[float], float]]] = {
    "abs": abs,
    "acos": _domain(lambda a: math.degrees(math.acos(a)), "acos"),
    "asin": _domain(lambda a: math.degrees(math.asin(a)), "asin"),
    "cos": lambda a: math.cos(math.radians(a)),
    "exp": math.exp,
    "fix": lambda a: float(math.floor(a)),
    "fup": lambda a: float(math.ceil(a)),
    "ln": _domain(math.log, "ln"),
    # Halves go away from zero, not to the even neighbour as Python's round does.
    "round": lambda a: math.copysign(math.floor(abs(a) + 0.5), a),
    "sin": lambda a: math.sin(math.radians(a)),
    "sqrt": _domain(math.sqrt, "sqrt"),
    "tan": lambda a: math.tan(math.radians(a)),
}


def whole(value: float, said: str) -> int:
    """A value that has to be a whole number, within LinuxCNC's tolerance.

    Raises:
        ProgramError: it is not.
    """
    number = round(value)
    if abs(value - number) > WHOLE:
        raise ProgramError(
            phrase("{said} has to be a whole number, not {value:g}", said=said, value=value)
        )
    return number


class Reader:
    """Reads values from ``text``, starting ``at`` a place."""

    __slots__ = ("_depth", "_parameters", "at", "text")

    def __init__(self, text: str, parameters: Parameters, at: int = 0) -> None:
        self.text = text
        self.at = at
        self._parameters = parameters
        self._depth = 0

    def peek(self) -> str:
        """The next character, or nothing at the end."""
        return self.text[self.at : self.at + 1]

    def rest(self) -> str:
        """What has not been read yet."""
        return self.text[self.at :]

    def take(self, character: str, after: str) -> None:
        """Step over a character that has to be here.

        Raises:
            ProgramError: it is not.
        """
        if self.peek() != character:
            found = f"{self.peek()!r}" if self.peek() else phrase("the line ends")
            raise ProgramError(
                phrase(
                    "{character} is missing after {after} ({found} instead)",
                    character=repr(character),
                    after=after,
                    found=found,
                )
            )
        self.at += 1

    def value(self) -> float:
        """A number, parameter, function or bracketed expression, with its signs.

        Raises:
            ProgramError: there is none, or it has no finite value.
        """
        negative = False
        while (sign := self.peek()) and sign in "+-":
            negative ^= sign == "-"
            self.at += 1
        value = self._unsigned(sign)
        if not -MAX_VALUE <= value <= MAX_VALUE:
            raise ProgramError(phrase("the value of the expression is too large"))
        return -value if negative else value

    def _unsigned(self, first: str) -> float:
        if first == "[":
            return self.expression()
        if first == "#":
            return self.parameter()
        if first.isalpha():
            return self._function()
        return self._number()

    def _number(self) -> float:
        match = _NUMBER.match(self.text, self.at)
        if match is None:
            found = f"{self.peek()!r}" if self.peek() else phrase("the end of the line")
            behind = self.text[self.at - 1 : self.at].upper()
            between = (
                phrase("between {behind} and {found}", behind=repr(behind), found=found)
                if behind
                else phrase("before {found}", found=found)
            )
            raise ProgramError(phrase("a number is missing {between}", between=between))
        self.at = match.end()
        return number(match.group())

    def expression(self) -> float:
        """A bracketed expression, brackets included.

        Raises:
            ProgramError: it is not one, or it is nested too deeply.
        """
        self._depth += 1
        if self._depth > MAX_DEPTH:
            raise ProgramError(
                phrase("brackets are nested more than {max_depth} deep", max_depth=MAX_DEPTH)
            )
        self.take("[", "this")
        value = self._binary(self.value(), 1)
        self.take("]", _EXPRESSION)
        self._depth -= 1
        return value

    def _binary(self, left: float, level: int) -> float:
        """Continue from ``left`` with all operators that bind at least as tight as level."""
        while (symbol := self._operator()) and OPERATORS[symbol][0] >= level:
            binds, operate = OPERATORS[symbol]
            self.at += len(symbol)
            right = self.value()
            while (after := self._operator()) and OPERATORS[after][0] > binds:
                right = self._binary(right, binds + 1)
            left = _computed(operate, left, right)
        return left

    def _operator(self) -> str:
        match = _OPERATOR.match(self.text, self.at)
        if match is not None:
            return match.group()
        if self.peek() not in ("]", ""):
            raise ProgramError(phrase("{rest} is not an operator", rest=repr(self.rest()[:8])))
        return ""

    def parameter(self) -> float:
        """A parameter with its number sign.

        Raises:
            ProgramError: it does not exist.
        """
        key = self.parameter_key()
        if isinstance(key, int):
            return self._parameters.get(key)
        value = self._parameters.find(key)
        if value is None:
            raise ProgramError(phrase("#<{key}> has not been set", key=key))
        return value

    def parameter_key(self) -> int | str:
        """Number or name of a parameter, without looking at its value.

        Raises:
            ProgramError: no parameter is here.
        """
        self.take("#", "this")
        if self.peek() == "<":
            return self.name()
        # Indices may nest as deeply as brackets: ##1, #[#2+1].
        self._depth += 1
        if self._depth > MAX_DEPTH:
            raise ProgramError(
                phrase("parameters are nested more than {max_depth} deep", max_depth=MAX_DEPTH)
            )
        index = whole(self.value(), _INDEX)
        self._depth -= 1
        return index

    def name(self) -> str:
        """A name in angle brackets.

        Raises:
            ProgramError: it is empty or not closed.
        """
        match = _NAME.match(self.text, self.at)
        if match is None or not match.group(1):
            raise ProgramError(phrase("a name in angle brackets is empty or not closed"))
        self.at = match.end()
        return match.group(1)

    def _function(self) -> float:
        match = _FUNCTION.match(self.text, self.at)
        if match is None:
            raise ProgramError(
                phrase("{rest} is neither a number nor a function", rest=repr(self.rest()[:8]))
            )
        self.at = match.end()
        name = match.group()
        if name == "exists":
            return self._exists()
        argument = self.expression()
        if name == "atan":
            self.take("/", phrase("the first argument of atan"))
            return math.degrees(math.atan2(argument, self.expression()))
        return _computed(lambda a, _: FUNCTIONS[name](a), argument, 0.0)

    def _exists(self) -> float:
        self.take("[", "exists")
        key = self.parameter_key()
        self.take("]", phrase("the parameter of exists"))
        if isinstance(key, int):
            return float(1 <= key <= MAX_INDEX)
        return float(self._parameters.find(key) is not None)


def number(text: str) -> float:
    """A plain decimal number.

    Raises:
        ProgramError: it is not one, or it is too large.
    """
    try:
        value = float(text)
    except ValueError:
        raise ProgramError(phrase("{text} is not a number", text=repr(text[:40]))) from None
    if not -MAX_VALUE <= value <= MAX_VALUE:
        raise ProgramError(phrase("{text}... is too large", text=text[:20]))
    return value


def _computed(operate: Binary, left: float, right: float) -> float:
    try:
        value = operate(left, right)
    except OverflowError:
        raise ProgramError(phrase("the value of the expression is too large")) from None
    if not math.isfinite(value):
        raise ProgramError(phrase("the value of the expression is too large"))
    return value
