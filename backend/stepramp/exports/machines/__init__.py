"""What machines and libraries that ramp by themselves are given for a design, as text, and what they lose of it."""
