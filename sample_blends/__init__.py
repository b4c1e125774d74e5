"""Sample scenes and the script that builds them."""
