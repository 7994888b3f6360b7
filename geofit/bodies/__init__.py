"""Closed and branching rock bodies as implicit surfaces, from drill-hole intervals, section outlines and points."""
