"""The family of controllers that speak grbl's dialect: grbl 1.1 itself, and grblHAL."""
