"""The commands: each reads its arguments, calls the model and the simulation, and prints."""
