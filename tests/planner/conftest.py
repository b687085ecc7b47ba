"""The same examples in every run; enough of them, and no deadline on a busy machine."""

from hypothesis import settings

settings.register_profile("planner", derandomize=True, deadline=None, max_examples=60)
settings.load_profile("planner")
