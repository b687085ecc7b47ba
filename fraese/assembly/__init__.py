"""Puts a machine together: drivers with their ports and clocks, cards, the simulated mill."""

from fraese.assembly.plant import Plant, assemble, state_folder

__all__ = ["Plant", "assemble", "state_folder"]
