"""What the app expects of the configuration file; handed in by the composition root."""

from collections.abc import Sequence
from typing import Any, Protocol

from fraese.control.controller import Controller


class Setting(Protocol):
    """One key of the file."""

    @property
    def key(self) -> str:
        """With its dots."""

    @property
    def table(self) -> str:
        """Where it stands; empty: above all tables."""

    @property
    def name(self) -> str:
        """In its table."""

    @property
    def sentence(self) -> str:
        """What it means, with its unit."""

    @property
    def bounds(self) -> str:
        """What it may be; may be empty."""

    @property
    def choices(self) -> Sequence[str]:
        """Where there are only some."""

    @property
    def value(self) -> str:
        """As it stands in the file; empty: nothing."""

    @property
    def default(self) -> str:
        """The same, where the file does not say."""

    @property
    def given(self) -> bool:
        """The file says it."""

    @property
    def is_text(self) -> bool:
        """May be typed without quotes."""

    @property
    def at_once(self) -> bool:
        """It counts as soon as it is written; else from the next start."""


class SettingsDesk(Protocol):
    """The configuration file. What it refuses is a ``ConfigError``, and the file is unchanged."""

    @property
    def path(self) -> str:
        """Of the file."""

    @property
    def is_there(self) -> bool:
        """There is such a file; else it is made with the first change."""

    def read(self) -> Sequence[Any]:
        """Every ``Setting``, as the file says now."""

    def other(self, key: str) -> Any:
        """A ``Setting`` that ``read`` does not have."""

    def check(self, setting: Any, typed: str) -> None:
        """Raises if this would not do."""

    def write(self, setting: Any, typed: str | None) -> Any:
        """Change one key, or (None) take it out; the whole configuration, for ``adopt``."""

    def adopt(self, controller: Controller, written: Any) -> None:
        """Let what counts at once be in force; in the machine's thread.

        Raises:
            StateError: if it cannot be now.
        """
