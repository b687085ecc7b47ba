"""One record for each card and each port: all that the rest of the house asks of it."""
