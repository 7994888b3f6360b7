"""Plain data: points, site, settings, results, messages, errors. No algorithms."""
