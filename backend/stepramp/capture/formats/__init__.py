"""The files that logic analysers write, each format in a module of its own."""
