"""Writes node groups and twins, as the plan says."""
