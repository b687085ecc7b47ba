"""Machine control for stepper-driven mills, in the terminal."""
