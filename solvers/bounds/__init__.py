"""Evidence for bounds: one module per method, in the room of its family; those for every family stand here."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

from ...formulations.evidence import Evidence
from ...formulations.stop import Stop
from ...instances.registry import Registry
from ..linear_programs import LinearPrograms

Compute = TypeVar("Compute", bound=Callable[..., Evidence | None])


@dataclass(frozen=True)
class BoundMethod:
    """A way to bound a problem, registered in ``BOUNDS``.

    Parameters
    ----------
    name : str
    missing : callable
        Features of the problem for which the method proves nothing (empty: it applies).
    compute : callable
        ``compute(problem, stop, linear)`` returns Evidence, or None where it found nothing before ``stop``, which it keeps in compiled
        loops too. Linear programs are solved by ``linear``, which knows the user's solver, seed and threads.
    order : int
        Cheap methods first. Those of order 0 are asked even where the time is over, and have nothing to prepare: they search nothing, or
        find nothing then.
    prepare : callable
        What it does once a process; not counted against the budget.
    kernels : tuple of str
        Modules of its compiled loops, and of those that its checker may need: where these were never compiled, the method's turn comes
        after all others.
    aims : bool
        Whether ``compute`` takes the keyword ``target`` too, the value of a known answer or None: such a method searches, and no bound
        beyond that value is worth its time.
    starts : bool
        Whether ``compute`` takes the keywords ``answer``, the answer at hand or None, and ``on_answer`` too, which hears of better ones
        with their values.
    replaces : callable
        Methods that this one stands for where a problem is of its family, whether it can take it or not.
    """

    name: str
    missing: Callable[[Any], frozenset[str]]
    compute: Callable[..., Evidence | None]
    order: int = 0
    prepare: Callable[[], None] = lambda: None
    replaces: Callable[[Any], frozenset[str]] = lambda problem: frozenset()
    aims: bool = False
    starts: bool = False
    kernels: tuple[str, ...] = ()

    def compiled(self) -> bool:
        """Whether the method can run without compiling: all its loops are loaded or in the cache."""
        if not self.kernels:
            return True
        from ...formulations.kernels import kernels

        return all(kernel.kept() for module in self.kernels for kernel in kernels(module))

    def evidence(
        self, problem: Any, stop: Stop, linear: LinearPrograms, target: float | None = None, answer: Any = None,
        on_answer: Callable[[Any, float], None] = lambda answer, value: None,
    ) -> Evidence | None:  # fmt: skip
        """The evidence that ``compute`` finds, if any."""
        known = ({"target": target} if self.aims else {}) | ({"answer": answer, "on_answer": on_answer} if self.starts else {})
        return self.compute(problem, stop, linear, **known)


BOUNDS: Registry[BoundMethod] = Registry("bound", "waybound.solvers.bounds", "waybound.solvers.bounds.*", group="waybound.bounds")


def bound_method(name: str, missing: Callable[[Any], frozenset[str]], **further: Any) -> Callable[[Compute], Compute]:
    """Register the decorated function ``compute`` as a ``BoundMethod``."""

    def entered(compute: Compute) -> Compute:
        BOUNDS.enter(BoundMethod(name, missing, compute, **further))
        return compute

    return entered


def of_family(family: str, lacks: Callable[[Any], frozenset[str]] = lambda problem: frozenset()) -> Callable[[Any], frozenset[str]]:
    """The ``missing`` of a method for one family: what ``lacks(problem)`` names there, and every other family as a whole."""

    def missing(problem: Any) -> frozenset[str]:
        return lacks(problem) if problem.family == family else frozenset({f"{problem.family} problems"})

    return missing


def instead_of(name: str, family: str) -> Callable[[Any], frozenset[str]]:
    """The ``replaces`` of a method that stands for another one in all problems of a family."""
    return lambda problem: frozenset({name} if problem.family == family else ())


def replaced(problem: Any) -> frozenset[str]:
    """Names of the methods that another one replaces for ``problem``."""
    return frozenset[str]().union(*(method.replaces(problem) for method in BOUNDS.values()))
