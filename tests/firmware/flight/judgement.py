"""What the judge says."""

from dataclasses import dataclass, field

from firmware.checker import CYCLES_PER_S, CYCLES_PER_US


@dataclass
class Judgement:
    """What is wrong, and what was measured."""

    faults: list[str] = field(default_factory=list)
    latest_us: float = 0.0
    """How much longer an interval was than the ramp allows at its place."""
    slowest_stop_ms: float = 0.0
    """From the first bit of a stop or halt to the last one of its answer."""
    in_flight: int = 0
    """Requests while a motor moved."""
    starved: int = 0

    def add(self, fault: str) -> None:
        self.faults.append(fault)


def at(cycles: float) -> str:
    return f"at {cycles / CYCLES_PER_S * 1e3:.3f} ms"


def us(cycles: float) -> str:
    return f"{cycles / CYCLES_PER_US:.2f} us"
