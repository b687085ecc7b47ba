"""The world of steps: blocks in, register writes out. Never learns of a millimetre."""
