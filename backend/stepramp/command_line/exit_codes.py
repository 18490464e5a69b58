"""What the program ends with, for scripts."""

OK = 0
FAILED = 1
"""The server or the device refused it, or it came out otherwise than asked."""
WRONG_INPUT = 2
NOBODY_THERE = 3
"""No server, no device, or it answers no more."""
INTERRUPTED = 130

MEANINGS = {
    OK: "done",
    FAILED: "refused by the server or the device, or not done as asked, as a push that reads back otherwise",
    WRONG_INPUT: "an option, an argument or a file that can't be used; nothing was done",
    NOBODY_THERE: "no server or no device is there, or it answers no more",
    INTERRUPTED: "interrupted by Ctrl+C, or ended by a signal: what this command had set in motion was stopped",
}
"""For people."""
