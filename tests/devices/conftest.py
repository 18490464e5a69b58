from controllers.conftest import clock, controller, plug_in, virtual

__all__ = ["clock", "controller", "plug_in", "virtual"]
