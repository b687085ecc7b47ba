"""Faults put into important lines, one at a time: do the tests see each of them?

    row --> copy of the tree --> the fault in it --> the tests named --> killed, or survived

Rule 1: a row names a line whose fault would hurt somebody, or spoil a workpiece, and the smallest
        set of tests that sees it. Its text stands in the file exactly once: else it is stale.
Rule 2: the tree itself is never touched. The copy must pass the tests named before any fault.
Rule 3: a fault that no test sees is worth a test, not a row less. One that changes nothing is no
        row.

``make mutate`` tries all of them, ``make mutate ONLY=bridge`` those with that in their name. It is
not part of CI; that every row still fits the tree is.
"""
