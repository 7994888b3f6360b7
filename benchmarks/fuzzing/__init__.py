"""Damaged files and messy sites, and the harness that runs them."""
