"""Trinamic's modules that speak TMCL: one or several motors, each with a ramp that the module computes itself."""
