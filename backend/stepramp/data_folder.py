"""Where what outlasts the program is kept."""

import os
from pathlib import Path

FOLDER_VARIABLE = "STEPRAMP_DATA"
"""Names another folder for what is kept than the user's own."""


def data_folder() -> Path:
    """Return where what outlasts the program is kept."""
    named = os.environ.get(FOLDER_VARIABLE)
    if named:
        return Path(named)
    import platformdirs  # noqa: PLC0415  # a stop that names its server does without

    return platformdirs.user_data_path("stepramp", appauthor=False)
