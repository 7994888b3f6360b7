"""Horizons to the files of other programs; one module a format.

Writers of triangles take :class:`geofit.geometry.mesh.Mesh` objects by horizon, writers of exact geometry take
:class:`geofit.HorizonFit`. Each writes to a temporary name, renames, and gives the same bytes for the
same input. Coordinates are metres of the map, but where a format stores single precision: there they are
relative to an origin that a text file beside it states.
"""
