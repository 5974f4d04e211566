import pytest

from waybound.formulations.kernels import kernels
from waybound.solvers.bounds.routing import branch_price_cut


@pytest.fixture(scope="session")
def compiled_pricing() -> None:
    """Kernels are compiled before a budget begins."""
    for module in branch_price_cut.KERNELS:
        for kernel in kernels(module):
            kernel.make()
