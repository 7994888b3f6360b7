"""B-spline bases and their sparse systems. Pure functions over arrays."""
