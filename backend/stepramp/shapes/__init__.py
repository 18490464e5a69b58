"""The shapes of a ramp: how speed and time grow along it. Each is a module here; shapes/slope.py is what all have."""
