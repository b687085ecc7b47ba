"""Settings for every test: property tests are modest and repeatable."""

from hypothesis import HealthCheck, settings

settings.register_profile(
    "fraese",
    derandomize=True,
    deadline=None,
    database=None,
    max_examples=60,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("fraese")
