"""How senders come to the machine: other programs that speak grbl's protocol."""

import ipaddress
from pathlib import Path
from typing import Final

from pydantic import Field, field_validator, model_validator

from fraese.config.section import Section
from fraese.phrases import phrase

#: Where a port without an address is.
_HERE: Final = "127.0.0.1"
_MOST_PORT: Final = 65_535
_NAMES_OF_HERE: Final = frozenset({"localhost", "ip6-localhost"})

Network = ipaddress.IPv4Network | ipaddress.IPv6Network


def address_of(text: str) -> tuple[str, int]:
    """Host and port of "2000", "127.0.0.1:2000" or "[::1]:2000".

    Raises:
        ValueError: it is none of these.
    """
    host, colon, port = text.strip().rpartition(":")
    host = host.removeprefix("[").removesuffix("]") if colon else _HERE
    if not (host and port.isascii() and port.isdigit() and int(port) <= _MOST_PORT):
        raise ValueError(phrase("must be a port, or an address and a port, as in 127.0.0.1:2000"))
    return host, int(port)


def is_here(host: str) -> bool:
    """Only this computer reaches it."""
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host in _NAMES_OF_HERE


class ServeConfig(Section):
    """Other programs that drive the machine (`fraese serve`): how they come to it."""

    link: str = Field(
        "", description="Path of a link to the pseudo-terminal of senders; empty: none is made."
    )
    tcp: str = Field(
        "",
        description=(
            "Port on which senders are let in besides, as in 2000; with an address in front of it,"
            " as in 0.0.0.0:2000, also from other computers; empty: no port."
        ),
    )
    allow: tuple[str, ...] = Field(
        (),
        max_length=100,
        description="Other computers that are let in, by address or network, as in 192.168.1.20.",
    )
    token_file: str = Field(
        "",
        description=(
            "File with a word; who sends it as his first line is let in from any computer; empty:"
            " nobody is."
        ),
    )

    app: bool = Field(False, description="Whether the app lets senders in while it is there.")

    @field_validator("tcp")
    @classmethod
    def _is_address(cls, value: str) -> str:
        if value:
            address_of(value)
        return value

    @field_validator("allow")
    @classmethod
    def _are_networks(cls, value: tuple[str, ...]) -> tuple[str, ...]:
        for each in value:
            try:
                ipaddress.ip_network(each, strict=False)
            except ValueError as error:
                raise ValueError(
                    phrase('"{each}" is no address or network, as in 192.168.1.20', each=each[:60])
                ) from error
        return value

    @model_validator(mode="after")
    def _not_open_to_all(self) -> "ServeConfig":
        if self.tcp and not self.allow and not self.token_file:
            host, _ = address_of(self.tcp)
            if not is_here(host):
                raise ValueError(
                    phrase(
                        "serve.tcp lets other computers in at {host}: say which by serve.allow, or"
                        " give serve.token_file",
                        host=host,
                    )
                )
        return self

    @property
    def networks(self) -> tuple[Network, ...]:
        """Whom ``allow`` lets in."""
        return tuple(ipaddress.ip_network(each, strict=False) for each in self.allow)

    @property
    def link_path(self) -> Path | None:
        """Of the link; None: none is made."""
        return Path(self.link).expanduser() if self.link else None
