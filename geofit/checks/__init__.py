"""Questions asked of a finished surface; one a module. :func:`geofit.check.check` asks them."""
