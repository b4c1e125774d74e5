"""Renders what probes see."""
