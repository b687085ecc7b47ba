"""O-words: branches, loops and calls, those by M98 and M99 included.

Control goes from label to label, as in LinuxCNC: a branch that is not taken skips forward
to the next O-word of the same name, whatever lies between. So a label names one construct;
using it for a second one is an error.

What must be kept in memory: the body of a loop while it runs, every subroutine that has been
defined, and, where a subroutine is called before it is defined, the lines in between.
"""

from collections.abc import Callable
from typing import Final

from fraese.errors import ProgramError
from fraese.gcode.callframes import Frame, Loop, has_come_to
from fraese.gcode.expressions import Reader, whole
from fraese.gcode.labels import LabelReader, OWord
from fraese.gcode.parameters import ARGUMENTS, Parameters, Scope
from fraese.gcode.setup import Setup
from fraese.gcode.source import Source
from fraese.gcode.subroutines import HEADS, PROGRAM_NUMBER, Library, Sub, bare
from fraese.phrases import joined, phrase

MAX_CALLS: Final = 9


class Flow:
    """The way through a program: which line comes next."""

    def __init__(self, source: Source, parameters: Parameters, setup: Setup) -> None:
        self.source = source
        self.frame = Frame(source)
        # lines since the last motion, counted where a loop or subroutine is running
        self.idle_lines = 0
        self._counted = 0
        self.value = 0.0
        self.value_returned = 0.0
        # whether M99 has ended the program itself
        self.over = False
        self._callers: list[Frame] = []
        self._parameters = parameters
        self._labels = LabelReader(parameters)
        self._library = Library(source, setup, self._labels.label)
        self._max_idle_lines = setup.max_idle_lines

    @property
    def call_level(self) -> int:
        """How many subroutines are running inside each other."""
        return len(self._callers)

    def calls(self) -> tuple[tuple[str, int], ...]:
        """Where the running subroutines were called: file and line, the innermost first."""
        return tuple((frame.source.file, frame.source.line) for frame in reversed(self._callers))

    def has_come_to(self, wanted: int, line: int) -> bool:
        """See ``callframes.has_come_to``."""
        return has_come_to((*self._callers, self.frame), wanted, line, self._library.holds(wanted))

    def next(self) -> str | None:
        """The next line, or None at the end of the program.

        Raises:
            ProgramError: too many lines went by without motion, or a subroutine has no end.
        """
        text = self.source.next()
        frame = self.frame
        if frame.loops or frame.name:
            self._count()
            if text is None and frame.sub is not None:
                raise ProgramError(phrase("subprogram O{name} ends without M99", name=frame.name))
            if text is None and frame.name:
                said = phrase("subroutine o<{name}> ends without endsub", name=frame.name)
                raise ProgramError(said)
        return text

    def _count(self) -> None:
        self.idle_lines += 1
        self._counted += 1
        if self.idle_lines > self._max_idle_lines:
            raise ProgramError(
                phrase(
                    "{max_idle_lines} lines went by without motion: {endless} never ends",
                    max_idle_lines=self._max_idle_lines,
                    endless=self._endless(),
                )
            )

    def _endless(self) -> str:
        """The innermost loop that ran for most of the time in which nothing moved."""
        before = self._counted - self._max_idle_lines // 2
        for frame in (self.frame, *reversed(self._callers)):
            for name, loop in reversed(frame.loops.items()):
                if loop.since <= before:
                    file = frame.source.file
                    place = phrase(" of {file}", file=file) if file != self.source.file else ""
                    return phrase(
                        "the loop o<{name}> that begins in line {place}{place_2}",
                        name=name,
                        place=loop.place,
                        place_2=place,
                    )
        return phrase("this loop")

    def end_of_tape(self) -> None:
        """A percent sign ends the program; where none opened it, subprograms may follow.

        Raises:
            ProgramError: more of the program follows, and would never be carried out.
        """
        source = self.source
        if source.is_framed:
            return
        place = source.hold()
        try:
            while (text := source.next()) is not None:
                label = self._labels.label(text)
                if label is not None and label[1] in HEADS:
                    return
                if text.strip() != "%" and bare(text):
                    raise ProgramError(
                        phrase(
                            "this stands behind the '%' in line {place}, which ends the program",
                            place=place,
                        ),
                        source.line,
                    )
        finally:
            source.back(place)
            source.release()

    def take(self, text: str) -> OWord:
        """Carry out what stands on a plain line that starts with O, M98 or M99.

        Raises:
            ProgramError: it is none, or does not fit here.
        """
        word = self._labels.read(text)
        self.do(word)
        return word

    def do(self, word: OWord) -> None:
        """Carry out an O-word.

        Raises:
            ProgramError: it does not fit here.
        """
        handler = _HANDLERS.get(word.keyword)
        if handler is None:
            raise ProgramError(
                phrase("{keyword} is not known behind an O-word", keyword=repr(word.keyword))
            )
        handler(self, word)

    def _skip(self, word: OWord, *keywords: str) -> OWord:
        """Go on to the next O-word of the same name with one of these keywords."""
        line = self.source.line
        while (text := self.source.next()) is not None:
            found = self._labels.passed(text)
            if found is not None and found.name == word.name and found.keyword in keywords:
                return found
        said = joined(phrase(" or "), keywords)
        raise ProgramError(
            phrase(
                "o<{name}> {keyword} has no {said} before the end of file",
                name=word.name,
                keyword=word.keyword,
                said=said,
            ),
            line,
        )

    def _begin(self, word: OWord) -> None:
        """A label belongs to one line, so that skipping finds the right end."""
        line = self.source.line
        first = self.frame.labels.setdefault(word.name, line)
        if first != line:
            raise ProgramError(
                phrase(
                    "label o<{name}> is already used in line {first}", name=word.name, first=first
                )
            )

    def _begun(self, word: OWord) -> None:
        if word.name not in self.frame.labels:
            raise ProgramError(
                phrase("o<{name}> {keyword} has no beginning", name=word.name, keyword=word.keyword)
            )

    # Branches

    def _if(self, word: OWord) -> None:
        self._begin(word)
        while not self._labels.condition(word):
            word = self._skip(word, "elseif", "else", "endif")
            if word.keyword != "elseif":
                return

    def _other_branch(self, word: OWord) -> None:
        """Met behind the branch that was taken: the others are left out."""
        self._begun(word)
        self._skip(word, "endif")

    # Loops

    def _while(self, word: OWord) -> None:
        loop = self.frame.loops.get(word.name)
        if loop is not None:
            self._end_of_do(word, loop)
            return
        self._begin(word)
        if self._labels.condition(word):
            self._enter(word)
        else:
            self._skip(word, "endwhile")

    def _do(self, word: OWord) -> None:
        self._begin(word)
        self._enter(word)

    def _repeat(self, word: OWord) -> None:
        self._begin(word)
        count = round(self._labels.number(word))
        if count > 0:
            self._enter(word, count)
        else:
            self._skip(word, "endrepeat")

    def _enter(self, word: OWord, left: int = 0) -> None:
        self.frame.loops[word.name] = Loop(word, self.source.hold(), left, self._counted)

    def _leave(self, word: OWord) -> None:
        del self.frame.loops[word.name]
        self.source.release()

    def _end_of_do(self, word: OWord, loop: Loop) -> None:
        if loop.head.keyword != "do":
            raise ProgramError(phrase("o<{name}> while is already running", name=word.name))
        if self._labels.condition(word):
            self.source.back(loop.place)
        else:
            self._leave(word)

    def _endwhile(self, word: OWord) -> None:
        loop = self._running(word, "while")
        if self._labels.condition(loop.head):
            self.source.back(loop.place)
        else:
            self._leave(word)

    def _endrepeat(self, word: OWord) -> None:
        loop = self._running(word, "repeat")
        loop.left -= 1
        if loop.left > 0:
            self.source.back(loop.place)
        else:
            self._leave(word)

    def _running(self, word: OWord, *keywords: str) -> Loop:
        loop = self.frame.loops.get(word.name)
        if loop is None or loop.head.keyword not in keywords:
            said = joined(phrase(" or "), keywords)
            raise ProgramError(
                phrase(
                    "o<{name}> {keyword} has no {said} to belong to",
                    name=word.name,
                    keyword=word.keyword,
                    said=said,
                )
            )
        return loop

    def _break(self, word: OWord) -> None:
        loop = self._running(word, "while", "do")
        self._skip(word, "endwhile" if loop.head.keyword == "while" else "while")
        self._leave(word)

    def _continue(self, word: OWord) -> None:
        loop = self._running(word, "while", "do")
        end = self._skip(word, "endwhile" if loop.head.keyword == "while" else "while")
        self.do(end)

    # Subroutines

    def _sub(self, word: OWord) -> None:
        if self.frame.name:
            raise ProgramError(
                phrase("o<{name}> sub cannot be defined inside a subroutine", name=word.name)
            )
        self._library.define(word.name, self.source)

    def _call(self, word: OWord) -> None:
        arguments = self._labels.expressions(word)
        if len(arguments) > ARGUMENTS:
            raise ProgramError(
                phrase("a call takes at most {arguments} arguments", arguments=ARGUMENTS)
            )
        self._go_deeper()
        sub = self._library.find(word.name)
        scope = self._parameters.enter(arguments)
        self._callers.append(self.frame)
        self.source = Source(sub.lines, sub.file, sub.first_line)
        self.frame = Frame(self.source, word.name, scope)

    def _go_deeper(self) -> None:
        if self.call_level >= MAX_CALLS:
            raise ProgramError(
                phrase(
                    "subroutines call each other more than {max_calls} deep", max_calls=MAX_CALLS
                )
            )

    def _return(self, word: OWord) -> None:
        frame = self.frame
        if frame.sub is not None:
            raise ProgramError(
                phrase("subprogram O{name} was called by M98 and returns by M99", name=frame.name)
            )
        if frame.scope is None:
            raise ProgramError(
                phrase(
                    "o<{name}> {keyword} stands outside any subroutine",
                    name=word.name,
                    keyword=word.keyword,
                )
            )
        values = self._labels.expressions(word)
        self.value = values[0] if values else 0.0
        self.value_returned = float(bool(values))
        self._back_from(frame.scope)

    def _back_from(self, scope: Scope) -> None:
        self._parameters.leave(scope)
        self.frame = self._callers.pop()
        self.source = self.frame.source

    # Subprograms as other controls have them: M98 P100 L2 calls O100 ... M99

    def _call_numbered(self, word: OWord) -> None:
        reader = Reader(word.rest, self._parameters)
        values: dict[str, float] = {}
        while letter := reader.peek():
            if letter not in "pl" or letter in values:
                raise ProgramError(
                    phrase("M98 takes P, the number, and L, how often, once each; no more")
                )
            reader.at += 1
            values[letter] = reader.value()
        if "p" not in values:
            raise ProgramError(phrase("M98 needs a P word: the number of the subprogram"))
        name = str(whole(values["p"], phrase("the P word of M98")))
        count = whole(values.get("l", 1.0), phrase("the L word of M98"))
        if count < 0:
            raise ProgramError(phrase("the L word of M98 must not be negative"))
        self._go_deeper()
        sub = self._library.find_numbered(name)
        if count:
            self._callers.append(self.frame)
            self._start(name, sub, count)

    def _start(self, name: str, sub: Sub, count: int) -> None:
        self.source = Source(sub.lines, sub.file, sub.first_line)
        self.frame = Frame(self.source, name, self._parameters.enter_names(), sub, count)

    def _end_numbered(self, word: OWord) -> None:
        frame = self.frame
        if word.rest:
            raise ProgramError(phrase("M99 has to stand alone on its line"))
        if frame.sub is None or frame.scope is None:
            if frame.name:
                raise ProgramError(
                    phrase("o<{name}> sub returns by endsub, not by M99", name=frame.name)
                )
            self.over = True
            return
        self._back_from(frame.scope)
        if frame.left > 1:
            self._callers.append(self.frame)
            self._start(frame.name, frame.sub, frame.left - 1)


_HANDLERS: Final[dict[str, Callable[[Flow, OWord], None]]] = {
    PROGRAM_NUMBER: lambda flow, word: None,
    "if": Flow._if,
    "elseif": Flow._other_branch,
    "else": Flow._other_branch,
    "endif": Flow._begun,
    "while": Flow._while,
    "endwhile": Flow._endwhile,
    "do": Flow._do,
    "repeat": Flow._repeat,
    "endrepeat": Flow._endrepeat,
    "break": Flow._break,
    "continue": Flow._continue,
    "sub": Flow._sub,
    "endsub": Flow._return,
    "return": Flow._return,
    "call": Flow._call,
    "m98": Flow._call_numbered,
    "m99": Flow._end_numbered,
}
