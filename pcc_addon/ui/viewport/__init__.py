"""What is drawn into 3D views."""
