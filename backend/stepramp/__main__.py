"""What `python -m stepramp` does: the same as the command `stepramp`."""

import sys

from stepramp.command_line.main import main

if __name__ == "__main__":
    sys.exit(main())
