"""What all numerics rest on: the types of numbers, how loops are compiled, how limits are told."""
