"""Surfaces, whatever made them: patches, trimmed faces, triangle meshes."""
