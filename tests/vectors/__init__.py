"""Inputs, exact results and tolerances of the lookup, for any engine's implementation."""
