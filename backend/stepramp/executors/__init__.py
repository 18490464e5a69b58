"""Who computes many things at once: the cores of this machine, or a cluster."""
