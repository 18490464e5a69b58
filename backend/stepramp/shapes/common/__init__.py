"""What shapes share."""
