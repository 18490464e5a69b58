"""Messages with their quantities in the units of a report."""

from collections.abc import Callable, Sequence

from stepramp.errors import StepUnit, Told
from stepramp.exports.printed.numbers import plain
from stepramp.numerics.limit_text import highest, lowest
from stepramp.units import Quantity, ShownUnits

QUANTITIES: dict[StepUnit, Quantity] = {
    "steps": "length",
    "steps/s": "speed",
    "steps/s²": "acceleration",
    "steps/s³": "jerk",
}
ROUNDED: dict[str, Callable[[float], float]] = {"nearest": float, "down": highest, "up": lowest}


def shown(value: float, units: ShownUnits, quantity: Quantity) -> str:
    """Return a quantity in steps and seconds as it is shown."""
    return f"{plain(units.factor(quantity) * value)} {units.word(quantity)}"


def in_units(message: str, told: Sequence[Told], units: ShownUnits) -> str:
    """Return a message with its quantities, in its order, in the units that are shown."""
    done, rest = "", message
    for each in told:
        quantity = QUANTITIES[each.unit]
        if units.factor(quantity) != 1:
            before, _, rest = rest.partition(each.text)
            value = ROUNDED[each.rounding](units.factor(quantity) * each.value)
            done += f"{before}{plain(value)} {units.word(quantity)}"
    return done + rest
