"""Problems, answers, evaluation, forms, combinatorial bounds, programs, solutions and certificates."""

from .. import _guard as _guard
