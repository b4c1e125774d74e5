"""The mathematics of parallax-corrected probes: NumPy and the standard library, never `bpy`."""
