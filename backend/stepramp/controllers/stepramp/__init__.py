"""The family of controllers that speak docs/serial_protocol.md."""
