"""Problems of risk as data."""

from ... import _guard as _guard
