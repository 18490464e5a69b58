"""Serial ports: what there is, how bytes get in and out, and one thread a port that owns it."""
