"""Controllers: one module a family, all behind one protocol class, and the registry of those that are connected."""
