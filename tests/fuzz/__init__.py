"""Whatever comes in: no traceback, no hang, no movement.

Bounded and the same every time in `make test`; `make fuzz` goes on for much longer with new
examples, FACTOR times as many. A target is a test with ``@fuzzed(n)`` and, around what may hang,
``with soon():``. What was found becomes an ``@example``.
"""
