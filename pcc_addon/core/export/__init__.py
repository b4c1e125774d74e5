"""Probes for other engines: pictures, numbers and shaders in each engine's own conventions."""
