"""Continuous relaxation of a linear program."""

from dataclasses import replace

from ..exactness import Exactness
from ..program import Program
from .reduction import Irreducible, Reduction, Step


class Continuous(Step):
    """The same variables, each of any value within its bounds."""

    name = "continuous-relaxation"


class ContinuousRelaxation(Reduction):
    """Drops integrality from linear programs."""

    may_refuse = True

    def apply(self, program: Program) -> tuple[Step, ...]:
        if program.quadratic is not None or program.cones or program.circuits:
            raise Irreducible(f"form {program.name} is not linear; only linear programs are relaxed")
        whole = int(program.integer.sum())
        relaxed = replace(program, variables=tuple(replace(b, integer=False) for b in program.variables))
        return (Continuous(program=relaxed, exactness=Exactness.RELAXATION, told=f"integrality of {whole} variables dropped"),)


CONTINUOUS_RELAXATION = ContinuousRelaxation()
