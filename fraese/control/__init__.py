"""The controller and all that it is made of: UI-free. Callbacks out, commands in."""
