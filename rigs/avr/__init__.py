"""A simulated ATmega328P; see README.md."""
