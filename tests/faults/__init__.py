"""Faults put in on purpose: what was there before, or was to come, is whole afterwards; the words say what to do."""
