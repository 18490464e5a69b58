"""The report that people send each other: what it says, and how that becomes a web page and paper."""
