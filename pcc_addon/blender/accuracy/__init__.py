"""Measuring on a scene what accuracy costs: the truth, settings of a probe and path tracing itself."""
