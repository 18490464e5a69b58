"""Machines with FluidNC."""
