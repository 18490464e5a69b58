"""How long the bodies of requests are."""

from firmware import protocol as p

FOR_AXES = {p.MOVE_BY: 5, p.MOVE_TO: 5, p.RUN: 5, p.LINE: 6, p.SET_POSITION: 5, p.ZERO: 3}
"""Lengths of the requests for axes that name one axis."""
CHANGES = {p.BEGIN: 4, p.DATA: 3, p.END: 0, p.COMMIT: 0, p.TRY: 0, p.ROLL_BACK: 0, p.WRITE_SETTINGS: 12}
LENGTHS = {p.HELLO: 1, p.STATUS: 1, p.REPORT: 1, p.TRACE: 3, p.READ: 4, p.READ_SETTINGS: 0} | CHANGES | FOR_AXES
