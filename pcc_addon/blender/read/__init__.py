"""Reads the scene into plain data; writes nothing."""
