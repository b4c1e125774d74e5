"""One module for each panel, in the manner of Blender's own."""
