"""The studies: each module of a wing's room registers what it measures in ``STUDIES``."""

from ... import _guard as _guard
