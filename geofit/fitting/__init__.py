"""The steps of the method, from the points of a horizon to its patches; one a module."""
