"""Panels beside and below the view; each takes plain data and emits signals."""
