"""What every table of the configuration is made of."""

from typing import Annotated, ClassVar

from pydantic import BaseModel, ConfigDict, Field

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]


class Section(BaseModel):
    """A table of the file; unknown keys are refused.

    Attributes:
        in_one_line: such a table in one line, for a file in which there is none.
    """

    in_one_line: ClassVar[str] = "{}"

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)
