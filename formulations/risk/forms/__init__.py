"""Forms of problems under risk."""

from .... import _guard as _guard
