"""The serial bridge: a microcontroller times the steps, a driver here feeds it."""
