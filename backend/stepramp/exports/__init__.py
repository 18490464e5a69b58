"""What a design is exported as: C headers, CSV, JSON, a page of plots to zoom, a report, pictures."""
