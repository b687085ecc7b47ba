"""What every table of the configuration is made of."""

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

from pydantic import BaseModel, ConfigDict, Field, ValidationInfo, field_validator

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]


@dataclass(frozen=True)
class Truth:
    """A true or false where none belongs: the checker would take ``True`` for the number 1."""

    value: bool

    def __str__(self) -> str:
        return str(self.value).lower()


class Section(BaseModel):
    """A table of the file; unknown keys are refused, and so is true for a number.

    Attributes:
        in_one_line: such a table in one line, for a file in which there is none.
    """

    in_one_line: ClassVar[str] = "{}"

    # Checkers are built when something is checked: that of the whole file has those of its tables.
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, defer_build=True)

    @field_validator("*", mode="before")
    @classmethod
    def _true_is_no_number(cls, value: Any, info: ValidationInfo) -> Any:
        is_switch = cls.model_fields[info.field_name or ""].annotation is bool
        return value if is_switch else _marked(value)


def _marked(value: Any) -> Any:
    """A value, also of lists, with every true and false as what it is."""
    if isinstance(value, bool):
        return Truth(value)
    return [_marked(part) for part in value] if isinstance(value, list) else value
