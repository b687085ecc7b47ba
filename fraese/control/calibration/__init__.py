"""Calibration: figures of a machine found by moving it, and what the configuration should say.

    routine --job--> controller --> motors
       |  '--facts()--> whoever shows how far it is, from any thread
       '--result--> Proposal: keys, old and new --consent--> the configuration file

Rule 1: a routine moves one axis, within bounds that it names before it moves.
Rule 2: it counts steps that were made, ``moves.py``, and leaves out what the configuration makes of
        them: a wrong pitch or a wrong backlash does not spoil what is measured.
Rule 3: nothing is written here, and nothing changes under a machine that runs: what is found counts
        from the next start.
"""
