"""Faults injected at random moments, many times: what was claimed afterwards, against the truth.

    python -m bench.campaign [WORD ...] [--tries N] [--seed S] [--jobs J] [--short]

    kind --n times--> attempt(folder, random, number) --> Outcome --> a row of the table
      ^ kinds.py: one line for each module of rows

Rule 1: truth comes from outside the process that is hurt: the fake port's carriages, the simulated
        microcontroller's pins, a mill in a process of its own. Never from what it says of itself.
Rule 2: an attempt has a folder and a random source of its own, which follows from seed, kind and
        number alone: ``--only NUMBER`` does the same one again.
Rule 3: whatever an attempt raises is a step unaccounted for, not the end of the campaign.

A new kind is a function and a ``Kind`` in a module's ``KINDS``; a new module is a line in
``kinds.py``.
"""
