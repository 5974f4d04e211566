"""Elements that are decided on: the part of a problem of choosing that is left when some are taken and some are dropped."""

import copy
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from ...instances.errors import InputError
from ...instances.instance import digest
from ...instances.number_arrays import Integers as Elements
from ...instances.printable import printable
from ..evaluation import Evaluation, judge
from ..problem import Decision, Problem

NONE: Elements = np.zeros(0, dtype=np.int64)

FEATURE = "decided-elements"
"""The feature of problems with decided elements, which the checkers and the judge alone take: methods are for whole problems."""


class DecidedElements(Problem):
    """A problem whose answers choose elements, of which every answer chooses the ``taken`` ones and none the ``dropped`` ones.

    Both are ascending; an element that is both leaves no answer.
    """

    taken: Elements = NONE
    dropped: Elements = NONE

    @property
    @abstractmethod
    def num_elements(self) -> int: ...

    @abstractmethod
    def element_name(self, element: int) -> str: ...

    @property
    def decided(self) -> bool:
        """True if any element is taken or dropped."""
        return len(self.taken) + len(self.dropped) > 0

    def check_statement(self, statement: Any) -> None:
        """Accept ``{"chosen": element}``, counted from 0."""
        element = statement["chosen"] if isinstance(statement, Mapping) and statement.keys() == {"chosen"} else None
        if type(element) is not int or not 0 <= element < self.num_elements:
            expected = f'{{"chosen": an element from 0 to {self.num_elements - 1}}}'
            raise InputError("not a statement on an element", expected=expected, found=printable(str(statement), 80))

    @staticmethod
    def at_most(column: int, most: int) -> Decision:
        """The decision that ``column <= most`` stands for in a form whose column k says whether element k is chosen."""
        return {"chosen": column}, most >= 1

    def in_words(self, statement: Any, holds: bool) -> str:
        return f"{self.element_name(statement['chosen'])} is {'taken' if holds else 'dropped'}"

    def restricted(self, decisions: Sequence[Decision]) -> Self:
        """The same problem with elements taken where the statement holds, and dropped where it does not."""
        for statement, _ in decisions:
            self.check_statement(statement)
        part = copy.copy(self)
        part.taken, part.dropped = (
            np.union1d(known, np.array([s["chosen"] for s, holds in decisions if holds is side], dtype=np.int64))
            for known, side in ((self.taken, True), (self.dropped, False))
        )
        return part

    def with_decided(self, evaluation: Evaluation, chosen: NDArray[np.integer[Any]]) -> Evaluation:
        """The evaluation of an answer, and whether it keeps to what is decided."""
        if not self.decided:
            return evaluation
        places = [
            *((e, "taken") for e in np.setdiff1d(self.taken, chosen)),
            *((e, "dropped") for e in np.intersect1d(self.dropped, chosen)),
        ]
        check, faults = judge("decided", np.ones(len(places)), lambda k: f"{self.element_name(int(places[k][0]))} is to be {places[k][1]}")
        return replace(evaluation, checks=(*evaluation.checks, check), violations=(*evaluation.violations, *faults))

    def digest_decided(self, whole: str) -> str:
        """Digest of the problem, ``whole`` being that of the whole one."""
        return digest(whole, self.taken, self.dropped) if self.decided else whole
