"""Everything that touches Blender's data: reading scenes, rendering, images, nodes."""
