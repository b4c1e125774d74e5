"""What accuracy costs in time: measurements of settings and of path tracing, and what follows from them."""
