"""The family of Pololu Tic stepper motor controllers, spoken to over their TTL serial port."""
