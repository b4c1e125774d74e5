"""From how far things are, as seen from one point, to the box of the room around it."""
