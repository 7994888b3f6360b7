"""Several horizons together: their order, where they cross, blocks between faults, a whole site."""
