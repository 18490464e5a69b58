"""A judge of motors in flight: says what is wrong with what a controller did and said while requests changed its moves.

It knows the edges of the pins, the frames on the line and the ramps that were delivered, not how the firmware plays
them. What it asks for stands in docs/serial_protocol.md. Times are cycles of 1/16 µs.
"""

import numpy as np

from firmware.flight.answers import judge_answers
from firmware.flight.exchange import exchanges
from firmware.flight.judgement import Judgement
from firmware.flight.lines import judge_lines
from firmware.flight.motion import Flight, axis_at, line_windows
from firmware.flight.orders import judge_orders
from firmware.flight.pins import judge_halts, judge_pins
from firmware.flight.setting import Setting
from firmware.flight.speed import judge_speed, pieces_of
from firmware.flight.words import judge_words
from simulator.avr import Conversation


def judge(conversation: Conversation, setting: Setting) -> Judgement:
    """Return what is wrong with a flight. All motors must be at rest at its end."""
    found = Judgement()
    heard = exchanges(conversation.frames)
    axes = [axis_at(conversation.edges, axis, setting) for axis in range(len(setting.slopes))]
    lines = line_windows(heard, np.sort(np.concatenate([axis.steps for axis in axes])))
    flights = [Flight(number, axis, setting, heard, lines) for number, axis in enumerate(axes)]
    for flight in flights:
        judge_pins(flight, found)
        judge_halts(flight, found)
        judge_words(flight, found)
        for piece in pieces_of(flight):
            judge_speed(piece, found)
            judge_orders(piece, found)
    judge_lines(flights, found)
    judge_answers(flights, heard, found)
    if conversation.statistics["lost_bytes"] or conversation.statistics["resets"] > 1:
        found.add(f"{conversation.statistics['lost_bytes']} bytes lost, {conversation.statistics['resets']} resets")
    return found
