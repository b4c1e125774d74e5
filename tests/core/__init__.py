"""Tests of `pcc_addon.core`: no Blender, seconds altogether."""
