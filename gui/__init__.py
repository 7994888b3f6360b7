"""Windows of geofit; they know everything below, and nothing knows them."""
