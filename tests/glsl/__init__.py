"""The formulas as GLSL: compiled, and run."""
