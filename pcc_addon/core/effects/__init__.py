"""What shaders may compute, one file an effect."""
