"""What all numerics rest on: slopes and ramps, types of numbers, how loops are compiled, how limits are told."""
