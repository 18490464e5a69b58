"""Captures: what a logic analyser saw of a motor's pins, and how far its steps are from a design's."""
