"""Machine control for stepper-driven mills, in the terminal."""

# Before any module of ours is imported it is settled in which form.
from fraese import compiled as compiled
