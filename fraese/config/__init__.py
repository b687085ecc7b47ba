"""The configuration: one TOML file, strictly read, every key with a sentence and its unit.

Rule 1: an unknown key is refused by name; a typing error never goes unnoticed.
Rule 2: every bound is stated here, in the field, and nowhere else.
"""

from fraese.config.config import Config

__all__ = ["Config"]
