"""The train of pulses through the two-phase model of a motor: what its rotor does, step by step.

J θ'' = T - T_det sin(4 N_r θ) - D (θ' - ω_cmd) - T_c sgn θ' - T_L, with T = K_m (-i_A sin N_r θ + i_B cos N_r θ). The
currents follow L di/dt = v - R i - e with a chopper that brings them to the microstep's in one step of the integration,
as far as the supply can. Integrated by semi-implicit Euler, R implicit, friction as an impulse that at most stops the
rotor. It begins at rest, held where the load has turned it, and is watched until it is held again. docs/motor.md.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stepramp.motor.step_width import integration_step_s, settling_step_s, settling_steps
from stepramp.numerics.compiled import compiled
from stepramp.numerics.drive_train import DriveTrain

SETTLED = 1 / 16
"""Of an electrical period: a quarter of a full step of two phases; within it of its end the rotor has settled."""
MOST_SETTLING = 4
"""A rotor that isn't held yet is watched so many times as long."""
PLACES = 256
"""Load angles up to 90° at which it is looked where the load has turned the rotor at rest."""
MOST_LOST = 10**9
"""Of a rotor that runs away nobody asks how many electrical periods it has run."""
PIECE = 200_000
"""After so many steps of the integration it is asked whether the answer is still wanted: some 20 ms."""


class NotWanted(Exception):
    """Nobody waits for the answer any more."""


@dataclass(frozen=True)
class Swing:
    """What a verdict is made of."""

    first_lost_step: int
    """The pulse after which the load angle passed 180°, counted from 1; 0: none."""
    is_lost_at_end: bool
    """Whether that was after the last interval."""
    is_held: bool
    """Whether the rotor has come to rest so far that it can't lose a step any more, or has lost one."""
    largest_load_angle_deg: float
    """Without its sign, until then [electrical °]."""


@dataclass(frozen=True)
class Run(Swing):
    """What the rotor did. Angles are electrical: 90° is a full step of two phases."""

    load_angles_deg: NDArray[np.float64]
    """The largest of each interval, with its sign: the field leads where it is above 0, shape (N,)."""
    speeds: NDArray[np.float64]
    """Mean speed of the rotor over each interval [steps/s], less than 0 backwards, shape (N,)."""
    lost_periods: int
    """Electrical periods that the rotor is behind at the end; MOST_LOST, or less than -MOST_LOST, stand for more."""
    overshoot_deg: float
    """How far beyond its end the rotor swings after the last interval, at most."""
    settled_after_s: float
    """From the end of the last interval; 12 natural periods where it hasn't settled by then."""


def run_of(
    train: DriveTrain,
    intervals_s: NDArray[np.float64],
    damping: float,
    *,
    finer: int = 1,
    is_wanted: Callable[[], bool] = lambda: True,
) -> Run:
    """Return what the rotor does that is given pulses with such intervals, from rest.

    intervals_s: as planned, shape (N,). damping: ζ, relative to the field. finer: so many times shorter steps of the
    integration. Raises NotWanted as soon as is_wanted says so.
    """
    constants, state = _constants(train, damping, integration_step_s(train) / finer), _at_rest(train)
    angles, speeds = np.empty(intervals_s.size), np.empty(intervals_s.size)
    _play_all(constants, state, intervals_s, angles, speeds, is_wanted)
    watched = _watch(train, constants, state, settling_steps(train) * finer, finer, is_wanted)
    behind = state[FIELD] - train.periods_per_rev * state[ANGLE]
    return Run(
        **_swing(state, watched),
        load_angles_deg=np.degrees(angles),
        speeds=speeds / train.radians_per_step,
        lost_periods=max(-MOST_LOST, min(round(behind / (2 * math.pi)), MOST_LOST)),
        overshoot_deg=math.degrees(watched[OVERSHOOT]),
        settled_after_s=float(watched[SETTLED_S]),
    )


def swing_of(
    train: DriveTrain,
    intervals_s: NDArray[np.float64],
    damping: float,
    is_wanted: Callable[[], bool] = lambda: True,
) -> Swing:
    """Return whether a step is lost, and how far the rotor is behind: as run_of does, but no more than decides it.

    A step that is lost ends it, and so does a rotor that is held after the last interval.
    """
    constants, state, nothing = _constants(train, damping, integration_step_s(train)), _at_rest(train), np.empty(0)
    _play_all(constants, state, intervals_s, nothing, nothing, is_wanted)
    return Swing(**_swing(state, _watch(train, constants, state, 0, 1, is_wanted)))


def _play_all(
    constants: NDArray[np.float64],
    state: NDArray[np.float64],
    intervals_s: NDArray[np.float64],
    angles: NDArray[np.float64],
    speeds: NDArray[np.float64],
    is_wanted: Callable[[], bool],
) -> None:
    is_whole = angles.size > 0
    while state[PULSE] < intervals_s.size and (is_whole or state[FIRST_LOST] < 0):
        if not is_wanted():
            raise NotWanted
        _play(constants, state, intervals_s, angles, speeds, PIECE)


def _watch(
    train: DriveTrain,
    constants: NDArray[np.float64],
    state: NDArray[np.float64],
    least: int,
    finer: int,
    is_wanted: Callable[[], bool],
) -> NDArray[np.float64]:
    """Watch the rotor for so many steps of the integration at least, and on until it is held or has lost a step."""
    watched, step_s = np.zeros(len(WATCHED)), settling_step_s(train) / finer
    most = MOST_SETTLING * settling_steps(train) * finer
    watched[AT_END] = state[FIRST_LOST] < 0
    while not watched[IS_DONE]:
        if not is_wanted():
            raise NotWanted
        _settle(constants, state, watched, step_s, least, most, PIECE)
    return watched


def _swing(state: NDArray[np.float64], watched: NDArray[np.float64]) -> dict[str, Any]:
    is_lost = state[FIRST_LOST] >= 0
    return {
        "first_lost_step": int(state[FIRST_LOST]) + 1,
        "is_lost_at_end": bool(is_lost and watched[AT_END]),
        "is_held": bool(is_lost or watched[IS_HELD]),
        "largest_load_angle_deg": math.degrees(state[LARGEST]),
    }


def _at_rest(train: DriveTrain) -> NDArray[np.float64]:
    """Return the state of a rotor that is held at the first field, with the currents that the supply can hold."""
    state = np.zeros(len(STATE))
    state[FIRST_LOST] = -1
    state[CURRENT_A] = train.static_torque_nm / train.torque_constant_nm_per_a
    state[ANGLE] = -math.copysign(_load_angle(train), train.load_nm) / train.periods_per_rev
    return state


def _load_angle(train: DriveTrain) -> float:
    """Return how far the load turns the rotor at rest [electrical rad]: asin(|T_L| / T_h), but for the detent torque.

    The first angle at which both bear the load; 90° where they never do.
    """
    angles = np.linspace(0, math.pi / 2, PLACES + 1)
    left = train.static_torque_nm * np.sin(angles) + train.detent_nm * np.sin(4 * angles) - abs(train.load_nm)
    borne = np.flatnonzero(left >= 0)
    if not borne.size or borne[0] == 0:
        return 0.0 if borne.size else math.pi / 2
    between = slice(int(borne[0]) - 1, int(borne[0]) + 1)
    return float(np.interp(0.0, left[between], angles[between]))


STATE = (
    "angle [rad]", "speed [rad/s]", "current A [A]", "current B [A]", "field [electrical rad]", "first lost step",
    "pulses that are played", "steps of the integration since the last one", "largest load angle since then",
    "angle at that pulse [rad]", "largest load angle of all",
)  # fmt: skip
ANGLE, SPEED, CURRENT_A, FIELD, FIRST_LOST, PULSE, LARGEST = 0, 1, 2, 4, 5, 6, 10
WATCHED = ("steps of the integration", "overshoot [rad]", "settled after [s]", "held", "done", "from an unlost step on")
OVERSHOOT, SETTLED_S, IS_HELD, IS_DONE, AT_END = 1, 2, 3, 4, 5


def _constants(train: DriveTrain, damping: float, longest_s: float) -> NDArray[np.float64]:
    drag = 2 * damping * 2 * math.pi * train.natural_frequency_hz * train.inertia_kg_m2
    return np.array(
        [
            train.resistance_ohm,
            train.inductance_h,
            train.torque_constant_nm_per_a,
            train.peak_current_a,
            train.supply_v,
            train.periods_per_rev,
            train.inertia_kg_m2,
            train.detent_nm,
            train.friction_nm,
            train.load_nm,
            drag,
            train.radians_per_step,
            longest_s,
        ]
    )


@compiled
def _play(constants, state, intervals, angles, speeds, most):  # type: ignore[no-untyped-def]  # compiled
    """Go on from where the state is, for about so many steps of the integration.

    angles, speeds: what is kept of each interval; of no size: nothing is, and a step that is lost ends it.
    """
    peak, periods, per_step, longest = constants[3], constants[5], constants[11], constants[12]
    i, part, largest, before = int(state[6]), int(state[7]), state[8], state[9]
    done = 0
    while i < intervals.size and done < most:
        if part == 0:
            state[4] += periods * per_step
            largest, before = 0.0, state[0]
        wanted_a, wanted_b = peak * np.cos(state[4]), peak * np.sin(state[4])
        parts = int(np.ceil(intervals[i] / longest))
        last = min(parts, part + most - done)
        h, commanded = intervals[i] / parts, per_step / intervals[i]
        for _ in range(part, last):
            _advance(constants, state, wanted_a, wanted_b, h, commanded)
            angle = state[4] - periods * state[0]
            if abs(angle) > abs(largest):
                largest = angle
        done += last - part
        part = last
        if part < parts:
            break
        if state[5] < 0:
            state[10] = max(state[10], abs(largest))
            if abs(largest) > np.pi:
                state[5] = i
        if angles.size:
            angles[i], speeds[i] = largest, (state[0] - before) / intervals[i]
        i, part = i + 1, 0
        if angles.size == 0 and state[5] >= 0:
            break
    state[6], state[7], state[8], state[9] = i, part, largest, before


@compiled
def _settle(constants, state, watched, h, least, most, piece):  # type: ignore[no-untyped-def]  # compiled
    """Go on for so many steps of the integration without pulses, noting the overshoot and when the rotor has settled.

    It is watched for `least` of them, and then until it is held, has lost a step, or `most` are done.
    """
    peak, periods, supply_a = constants[3], constants[5], constants[4] / constants[0]
    wanted_a, wanted_b = peak * np.cos(state[4]), peak * np.sin(state[4])
    held_a, held_b = min(max(wanted_a, -supply_a), supply_a), min(max(wanted_b, -supply_a), supply_a)
    energies = _energies(constants, state[4], held_a, held_b)
    close = 2 * np.pi * SETTLED
    for _ in range(piece):
        if watched[3] == 0.0 and state[5] < 0 and _is_held(constants, state, held_a, held_b, energies):
            watched[3] = 1.0
        is_decided = watched[3] != 0.0 or state[5] >= 0
        if watched[0] >= most or (is_decided and watched[0] >= least):
            watched[4] = 1.0
            return
        _advance(constants, state, wanted_a, wanted_b, h, 0.0)
        watched[0] += 1
        angle = state[4] - periods * state[0]
        if watched[3] == 0.0 and state[5] < 0:
            state[10] = max(state[10], abs(angle))
            if abs(angle) > np.pi:
                state[5] = state[6] - 1
        # Of the end that it comes to: where steps were lost that is another one.
        angle -= 2 * np.pi * np.round(angle / (2 * np.pi))
        watched[1] = max(watched[1], -angle)
        if abs(angle) > close and watched[0] <= least:
            watched[2] = watched[0] * h


@compiled
def _is_held(constants, state, held_a, held_b, energies):  # type: ignore[no-untyped-def]  # compiled
    """Tell whether the rotor can't lose a step any more: its energy, and that of its currents, never grows again.

    With less of it than the barriers to either side have, it stays between them: less by a tenth of how high they are,
    for what the integration leaves uncertain. Friction may hold it wherever it rests.
    """
    inductance, constant, periods, inertia, friction = (
        constants[1], constants[2], constants[5], constants[6], constants[8],
    )  # fmt: skip
    off_a, off_b, angle = state[2] - held_a, state[3] - held_b, state[4] - periods * state[0]
    energy = inertia * state[1] ** 2 / 2 + inductance * (off_a * off_a + off_b * off_b) / 2
    energy += _potential(constants, state[0], held_a, held_b)
    place = int(np.floor((angle + np.pi) / (2 * np.pi) * (energies.size - 1)))
    if 0 <= place < energies.size - 1:
        left, right = energies[: place + 1].argmax(), place + 1 + energies[place + 1 :].argmax()
        barrier, lowest = min(energies[left], energies[right]), energies[left : right + 1].min()
        if energy < lowest + 0.9 * (barrier - lowest):
            return True
    sine, cosine = np.sin(periods * state[0]), np.cos(periods * state[0])
    torque = constant * (held_b * cosine - held_a * sine)
    torque -= constants[7] * 4 * sine * cosine * (1 - 2 * sine * sine) + constants[9]
    excess = constant * (abs(off_a) + abs(off_b))
    return state[1] == 0.0 and abs(torque) + excess < friction


@compiled
def _energies(constants, field, held_a, held_b):  # type: ignore[no-untyped-def]  # compiled
    """Return the energy of a rotor at rest at load angles from -180° to 180°, evenly spaced [J]."""
    energies = np.empty(257)
    for place in range(energies.size):
        angle = np.pi * (2 * place / (energies.size - 1) - 1)
        energies[place] = _potential(constants, (field - angle) / constants[5], held_a, held_b)
    return energies


@compiled
def _potential(constants, angle, current_a, current_b):  # type: ignore[no-untyped-def]  # compiled
    """Return the energy of the rotor at an angle [rad] in the field of such currents, its detent and its load [J]."""
    constant, periods, detent, load = constants[2], constants[5], constants[7], constants[9]
    cosine, sine = np.cos(periods * angle), np.sin(periods * angle)
    of_field = -constant / periods * (current_a * cosine + current_b * sine)
    # cos 4x = 1 - 8 sin² x cos² x
    of_detent = -detent / (4 * periods) * (1 - 8 * sine * sine * cosine * cosine)
    return of_field + of_detent + load * angle


@compiled
def _advance(constants, state, wanted_a, wanted_b, h, commanded):  # type: ignore[no-untyped-def]  # compiled
    """Take one step of the integration of h seconds, towards the currents of the microstep.

    commanded: speed of the field [rad/s]. A rotor that runs away, by more than half an electrical period a step, has
    left the field: neither it nor the detent pulls it either way then.
    """
    resistance, inductance, constant, _, supply, periods, inertia, detent, friction, load, drag = constants[:11]
    speed = state[1]
    torque = -drag * (speed - commanded) - load
    if abs(periods * speed * h) < np.pi:
        sine, cosine = np.sin(periods * state[0]), np.cos(periods * state[0])
        back_a, back_b = -constant * speed * sine, constant * speed * cosine
        state[2] = _current(state[2], wanted_a, back_a, h, resistance, inductance, supply)
        state[3] = _current(state[3], wanted_b, back_b, h, resistance, inductance, supply)
        # sin 4x = 4 sin x cos x (1 - 2 sin² x)
        torque += constant * (state[3] * cosine - state[2] * sine) - detent * 4 * sine * cosine * (1 - 2 * sine * sine)
    else:
        state[2] = state[3] = 0.0
    speed += h * torque / inertia
    impulse = h * friction / inertia
    speed = speed - impulse if speed > impulse else speed + impulse if speed < -impulse else 0.0
    state[1] = speed
    state[0] += h * speed


@compiled
def _current(current, wanted, back, h, resistance, inductance, supply):  # type: ignore[no-untyped-def]  # compiled
    """Return the current of a phase after h seconds: the wanted one, as far as the supply brings it there."""
    lasting = 1 + h * resistance / inductance
    voltage = back + (wanted * lasting - current) * inductance / h
    voltage = min(max(voltage, -supply), supply)
    return (current + h / inductance * (voltage - back)) / lasting
