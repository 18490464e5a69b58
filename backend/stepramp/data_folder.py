"""Where what outlasts the program is kept."""

import os
import warnings
from pathlib import Path

FOLDER_VARIABLE = "STEPRAMP_DATA"
"""Names another folder for what is kept than the user's own."""
RUNTIME_VARIABLE = "STEPRAMP_RUNTIME"
"""Names another folder for what is told only while a program runs than the user's own."""


def runtime_folder() -> Path:
    """Return where programs of this user tell that they run, wherever each keeps its data."""
    named = os.environ.get(RUNTIME_VARIABLE)
    if named:
        return Path(named)
    import platformdirs  # noqa: PLC0415

    with warnings.catch_warnings():
        # Where the system has no such folder, one of the temporary files' folder serves as well.
        warnings.simplefilter("ignore")
        return platformdirs.user_runtime_path("stepramp", appauthor=False)


def data_folder() -> Path:
    """Return where what outlasts the program is kept."""
    named = os.environ.get(FOLDER_VARIABLE)
    if named:
        return Path(named)
    import platformdirs  # noqa: PLC0415  # a stop that names its server does without

    return platformdirs.user_data_path("stepramp", appauthor=False)
