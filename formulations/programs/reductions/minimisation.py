"""Minimisation without a constant, for solvers whose formats know no other, or disagree about its sign."""

from dataclasses import dataclass, replace

from ..program import Floats, Program
from .reduction import Reduction, Step


@dataclass(frozen=True, eq=False, kw_only=True)
class Minimised(Step):
    """A program whose value is ``sign`` times its own objective, plus ``constant``."""

    name = "minimisation"
    sign: float
    constant: float

    def value(self, value: float) -> float:
        return self.sign * value + self.constant

    def duals(self, duals: Floats) -> Floats:
        return self.sign * duals


class Minimisation(Reduction):
    """Turns the sign of an objective to be maximised, and leaves out its constant."""

    def apply(self, program: Program) -> tuple[Step, ...]:
        turned = program.sense == "max"
        if not turned and program.offset == 0.0:
            return ()
        minimised = replace(program, sense="min", offset=0.0)
        if turned:
            quadratic = None if program.quadratic is None else -program.quadratic
            minimised = replace(minimised, variables=tuple(replace(b, cost=-b.cost) for b in program.variables), quadratic=quadratic)
        notes = [*(["sign turned"] if turned else []), *([f"constant {program.offset:g} left out"] if program.offset else [])]
        return (Minimised(program=minimised, told=", ".join(notes), sign=-1.0 if turned else 1.0, constant=program.offset),)


MINIMISATION = Minimisation()
