"""Playing a ramp: what a motor plays of it, from rest or in flight, until it comes to rest."""
