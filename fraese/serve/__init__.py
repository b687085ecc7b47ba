"""The machine for other programs: senders that speak grbl's protocol, on a line of theirs."""
