"""The one place that chooses who computes many things at once."""

import os
from collections.abc import Iterator
from contextlib import contextmanager

from stepramp.executors.cluster import VARIABLE, connected
from stepramp.executors.contract import Executor
from stepramp.executors.threads import Threads

LOCAL = Threads()


@contextmanager
def executor() -> Iterator[Executor]:
    """Yield the cluster that STEPRAMP_DASK names, or else the cores of this machine.

    Raises Rejected when no such cluster answers.
    """
    address = os.environ.get(VARIABLE, "")
    if not address:
        yield LOCAL
        return
    with connected(address) as cluster:
        yield cluster
