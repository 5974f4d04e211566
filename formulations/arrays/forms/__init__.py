"""The form of a bare program."""
