"""The 3D view of a site: layers, picking, measuring, sections, pictures."""
