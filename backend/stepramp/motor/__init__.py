"""What a motor does with a ramp: pure numerics over a drive train and the ticks of a plan: docs/motor.md."""
