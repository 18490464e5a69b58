"""Pure numerics of ramps: arrays in, arrays out. Nothing here knows of HTTP, files, serial ports or plots."""
