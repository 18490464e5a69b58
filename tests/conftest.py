"""What holds for all tests."""

from hypothesis import settings

# The first example of a test may compile what it tests; and no test judges by the clock.
settings.register_profile("stepramp", deadline=None)
settings.load_profile("stepramp")
