"""What is drawn from a surface: sections, contours, grids."""
