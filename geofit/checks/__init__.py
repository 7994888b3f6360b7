"""Questions asked of a finished surface; one a module. :func:`geofit.checks.check.check` asks them."""
