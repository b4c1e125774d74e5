"""Exports in real engines."""
