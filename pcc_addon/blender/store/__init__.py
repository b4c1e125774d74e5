"""Pictures and records on disk and in the file."""
