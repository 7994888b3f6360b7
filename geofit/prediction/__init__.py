"""How well a surface predicts rock that nobody drilled: points left out, bands, next holes, outliers."""
