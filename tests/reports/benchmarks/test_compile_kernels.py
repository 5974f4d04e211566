import subprocess
import sys


def test_each_kernel_is_listed_with_its_seconds() -> None:
    made = subprocess.run(
        [sys.executable, "-m", "waybound.reports.benchmarks.compile_kernels", "waybound.formulations.auctions.matching_kernels"],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert "formulations.auctions.matching_kernels.matched" in made.stdout and "in all, limit 30 s" in made.stdout
