"""The steps of the method, from the points of a horizon to its sewn patches; one a module."""
