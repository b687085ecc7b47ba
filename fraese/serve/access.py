"""Who may come in over the network.

    this computer            always
    allowed addresses        always
    anybody else             with the token as his first line; without a token: nobody

Rule 1: a token is compared as a whole, in a time that says nothing of it; nothing is said to who
        has not given it.
"""

import hmac
import ipaddress
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from fraese.config.serving import Network
from fraese.errors import ConfigError
from fraese.phrases import phrase, reason

#: A shorter one is guessed.
LEAST_TOKEN: Final = 16
MOST_TOKEN: Final = 200


class Access:
    """Who may come in.

    Args:
        networks: from where, besides this computer.
        token: opens for everybody who knows it; empty: there is none.
    """

    def __init__(self, networks: Sequence[Network], token: str) -> None:
        self._networks = networks
        self._token = token.encode()

    @property
    def has_token(self) -> bool:
        """Strangers are asked for it."""
        return bool(self._token)

    def admits(self, address: str) -> bool:
        """Without a token."""
        there = ipaddress.ip_address(address.partition("%")[0])
        mapped = getattr(there, "ipv4_mapped", None)
        there = mapped or there
        return there.is_loopback or any(there in network for network in self._networks)

    def knows(self, line: bytes) -> bool:
        """Somebody has said the token."""
        return self.has_token and hmac.compare_digest(line.strip(), self._token)


def token_of(path: Path | None) -> str:
    """The token that a file holds; without a file, none.

    Raises:
        ConfigError: it cannot be read, or is none.
    """
    if path is None:
        return ""
    try:
        with path.open("rb") as file:
            token = file.read(MOST_TOKEN + 2).decode("ascii").strip()
    except OSError as error:
        raise ConfigError(
            phrase("{path}: cannot be read: {reason}.", path=path, reason=reason(error))
        ) from error
    except UnicodeDecodeError:
        token = ""
    if not LEAST_TOKEN <= len(token) <= MOST_TOKEN or not token.isprintable() or " " in token:
        raise ConfigError(
            phrase(
                "{path}: a token is one word of {least} to {most} ASCII characters.",
                path=path,
                least=LEAST_TOKEN,
                most=MOST_TOKEN,
            )
        )
    return token
