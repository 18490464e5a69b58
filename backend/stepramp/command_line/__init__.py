"""The command line: `stepramp` starts the server, `stepramp COMMAND` does one thing."""
