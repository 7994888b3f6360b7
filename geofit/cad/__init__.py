"""OpenCASCADE: faces, trimming, sewing, STEP, IGES, BREP, and what is read back from them."""
