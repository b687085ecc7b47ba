"""The X4Step library: tried as programs use it, on simulated ports, judged by their lines."""
