"""One file per machine that a power cut leaves whole, and a lock; knows bytes, no machine."""

from fraese.journal.lock import Holder, MachineLock
from fraese.journal.names import machine_file
from fraese.journal.pages import MOST_BYTES
from fraese.journal.store import Found, Journal

__all__ = ["MOST_BYTES", "Found", "Holder", "Journal", "MachineLock", "machine_file"]
