"""The version, for floors that must not import the face."""

__version__ = "0.2.0"
