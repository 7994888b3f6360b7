"""A surface seen as geometry: frames, points on it, distances, triangles, sections and contours."""
