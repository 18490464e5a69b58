"""Devices: controllers of any family, each at its port, and the registry of those that are connected."""
