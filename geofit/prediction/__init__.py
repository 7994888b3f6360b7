"""How well a surface predicts away from its data: points left out, bands, next holes, outliers."""
