"""What a person has made his own: the keys of the app, and macros."""

import re
from pathlib import Path
from typing import Annotated, Any, Final

from pydantic import BeforeValidator, Field, field_validator, model_validator

from fraese.config.section import Section
from fraese.phrases import phrase

#: What can stand on a button and in a message.
_NAME: Final = re.compile(r"[^\x00-\x1f\x7f/\\\\]{1,24}")


def _one_or_several(value: Any) -> Any:
    return (value,) if isinstance(value, str) else value


#: One key, or several that do the same. Which there are, the app knows.
KeyNames = Annotated[
    tuple[Annotated[str, Field(min_length=1, max_length=30)], ...],
    BeforeValidator(_one_or_several),
    Field(min_length=1, max_length=6),
]


def _in_lines(value: Any) -> Any:
    return tuple(value.splitlines()) if isinstance(value, str) else value


class MacroConfig(Section):
    """A button with lines of G-code, or with a file of them."""

    name: str = Field(description="What stands on the button.")
    key: KeyNames | None = Field(None, description="Its key in Move, or several; without, none.")
    lines: Annotated[tuple[str, ...], BeforeValidator(_in_lines)] = Field(
        (), max_length=200, description="G-code, a list of lines or one text."
    )
    file: str = Field("", description="A file with G-code instead, by its whole path.")
    confirm: bool = Field(
        True, description="Whether its lines are shown first, and run with a second key."
    )

    @field_validator("name")
    @classmethod
    def _can_be_shown(cls, value: str) -> str:
        if not _NAME.fullmatch(value) or not value.strip():
            raise ValueError(phrase("must be 1 to 24 characters, without / and \\"))
        return value

    @field_validator("file")
    @classmethod
    def _is_whole(cls, value: str) -> str:
        if value and not (value.startswith("~") or Path(value).is_absolute()):
            raise ValueError(phrase('"{file}" is no whole path; begin it with / or ~', file=value))
        return value

    @model_validator(mode="after")
    def _has_one_of_both(self) -> "MacroConfig":
        if bool(self.file) == bool(any(line.strip() for line in self.lines)):
            raise ValueError(phrase("a macro has either lines or a file"))
        return self
