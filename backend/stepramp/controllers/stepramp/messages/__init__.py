"""Messages: requests, replies and notices as objects, and as bytes. What they mean is in docs/serial_protocol.md.

Nothing here reads or writes a port.
"""
