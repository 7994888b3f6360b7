"""What geofit is compared with: OpenCASCADE's plate and a plain sparse P-spline."""
