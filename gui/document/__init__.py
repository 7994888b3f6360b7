"""The document behind the windows: plain state, commands, journal; it knows no Qt."""
