"""What the simulated mill is like."""

from pydantic import Field

from fraese.config.section import NotNegative, Positive, Section


class SimulationConfig(Section):
    """The simulated mill."""

    max_rate_hz: Positive = Field(6000, description="Above it a rotor stalls, steps/s.")
    jump_hz: Positive = Field(1200, description="Start/stop rate of a rotor, steps/s.")
    acceleration_hz_s: Positive = Field(
        60_000, description=("Change of rate that a rotor can follow, steps/s per second.")
    )
    snaps_to_pole: bool = Field(
        False,
        description=(
            "Whether a rotor without current turns to its nearest pole; else friction holds it."
        ),
    )
    overrun_mm: NotNegative = Field(
        2, description=("Way of a carriage behind its switch, to the mechanical end, mm.")
    )
    backlash_mm: NotNegative = Field(
        0, description="How far a spindle turns back before its carriage follows, mm."
    )
    lag_ms: float = Field(
        0, ge=0, le=1000, description=("From the carriage's arrival to the contact, ms.")
    )
    bounce_readings: int = Field(
        0, ge=0, le=100, description=("Readings after each change that bounce.")
    )
