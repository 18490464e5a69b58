"""The family of machines with Marlin, from 1.1 on."""
