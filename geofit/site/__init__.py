"""Several horizons together: fault blocks, throw, order, separation, site checks."""
