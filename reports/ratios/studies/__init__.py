"""The studies: each module registers what it measures in ``STUDIES``."""

from .... import _guard as _guard
