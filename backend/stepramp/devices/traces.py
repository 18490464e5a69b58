"""Traces: when a controller made the steps of its last move."""

from collections.abc import Callable

from stepramp.capture.channels import EACH_EDGE
from stepramp.capture.formats.saleae_csv import csv_of_steps
from stepramp.controllers.capabilities import TracesMoves
from stepramp.controllers.contract import NextTrace, Trace
from stepramp.devices.contact import Contact
from stepramp.devices.watch import Watch
from stepramp.errors import Refused


class Traces:
    """Has moves traced. From any thread."""

    def __init__(self, contact: Contact, watch: Watch) -> None:
        self._contact = contact
        self._watch = watch

    def of_moves(self, axis: int | None, every_steps: int) -> NextTrace:
        """Trace every so many-th step of each move of an axis from now on; see TracesMoves."""
        return self._contact.ask_one_who(TracesMoves, lambda controller: controller.trace_moves(axis, every_steps))

    def last(self) -> Trace:
        """Return the trace of the last move that was traced, as far as it is known; Refused before there was one."""
        work_out = self._contact.ask_one_who(TracesMoves, self._heard)
        if work_out is None:
            raise Refused("No move has been traced yet: ask for a trace, then move.")
        return work_out()

    def last_as_csv(self) -> str:
        """Return the same as a file like those of logic analysers, which holds instants and no numbers of steps.

        Raises Refused also when the trace lacks steps.
        """
        trace = self.last()
        if not trace.step.size:
            raise Refused("The trace has no steps yet.")
        lacking = int(trace.step[-1]) - trace.step.size
        if lacking:
            raise Refused(
                f"The trace lacks {lacking:,} of its first {int(trace.step[-1]):,} steps, so that it can't be saved as "
                "a capture: trace every step, of a slower or shorter move."
            )
        return csv_of_steps(f"Step ({EACH_EDGE})", trace.measured_ticks, trace.timer_hz)

    def _heard(self, controller: TracesMoves) -> Callable[[], Trace] | None:
        self._watch.listen()
        return controller.trace
