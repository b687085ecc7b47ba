"""Judged by rs274, the interpreter of LinuxCNC on the command line."""
