"""The one place where units are converted."""

MICROSECONDS_PER_SECOND = 1_000_000


def ticks_from_us(microseconds: float, frequency_hz: float) -> float:
    """Return a time [µs] in ticks of a timer [Hz], not rounded."""
    return microseconds * frequency_hz / MICROSECONDS_PER_SECOND


def us_from_ticks(ticks: float, frequency_hz: float) -> float:
    """Return a number of ticks of a timer [Hz] as a time [µs]."""
    return ticks * MICROSECONDS_PER_SECOND / frequency_hz


def speed_from_interval(ticks: float, frequency_hz: float) -> float:
    """Return the speed [steps/s] at which one step takes so many ticks of a timer [Hz]: formula (7), v = F / p."""
    return frequency_hz / ticks
