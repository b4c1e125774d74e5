"""What runs or prints expressions."""
