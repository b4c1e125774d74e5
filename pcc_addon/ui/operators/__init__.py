"""One module for each thing that a button does. They gather what is asked, call `blender/`, and report."""
