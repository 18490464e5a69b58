"""Machines with Klipper."""
