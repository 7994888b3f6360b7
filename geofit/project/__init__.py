"""A piece of work: its state, commands with undo, provenance, journal, runs. No Qt."""
