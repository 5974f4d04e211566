"""Problems of risk."""

from ... import _guard as _guard
