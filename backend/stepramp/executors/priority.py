"""How much a computing thread lets others go before."""

import os
import sys
import threading


def be_nicer(by: int) -> None:
    """Let the system prefer other threads to the one that calls: those that wait for clients and controllers."""
    if sys.platform == "linux":  # Elsewhere priorities are those of processes.
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), os.getpriority(os.PRIO_PROCESS, 0) + by)
