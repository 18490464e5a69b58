"""What ramp methods are made of: what each has to say of itself, and the numerics that several share."""
