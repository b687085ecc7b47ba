"""What a person has made his own: the keys of the app."""

from typing import Annotated, Any

from pydantic import BeforeValidator, Field


def _one_or_several(value: Any) -> Any:
    return (value,) if isinstance(value, str) else value


#: One key, or several that do the same. Which there are, the app knows.
KeyNames = Annotated[
    tuple[Annotated[str, Field(min_length=1, max_length=30)], ...],
    BeforeValidator(_one_or_several),
    Field(min_length=1, max_length=6),
]
