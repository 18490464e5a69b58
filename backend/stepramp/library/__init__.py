"""The library: designs that are kept, each with all its revisions."""
