"""What was last found out of the open file, for panels and viewports: they are drawn many times a second."""
