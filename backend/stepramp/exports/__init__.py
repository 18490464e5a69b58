"""What a design is exported as: C headers, CSV, JSON, a report, pictures."""
