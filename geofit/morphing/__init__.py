"""Metamorphosis: what lies between two bodies, with dates, volumes, and what cannot be known."""
