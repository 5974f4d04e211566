"""CPU seconds that each kernel takes to compile, in an empty cache and one process: what all share counts for the first.

Names of modules as arguments list these alone. Exit code 1 if all of them take more than 30 s.
"""

import os
import sys
import tempfile
import time

LIMIT = 30.0


def main(modules: list[str]) -> int:
    os.environ["NUMBA_CACHE_DIR"] = folder = tempfile.mkdtemp(prefix="kernels-")  # before numba is imported
    from waybound.formulations.kernels import kernel_modules, kernels

    total = 0.0
    for module in modules or list(kernel_modules()):
        for kernel in kernels(module):
            began = time.process_time()
            kernel.make()
            seconds = time.process_time() - began
            total += seconds
            print(f"{seconds:7.2f} s  {kernel.title}", flush=True)
    print(f"{total:7.2f} s  in all, limit {LIMIT:g} s; compiled in {folder}")
    return int(total > LIMIT)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
