"""Free memory, asked before something large is allocated."""

import os
from pathlib import Path

SHARE = 0.8
"""Share of the free memory that one array may take."""


def available() -> float:
    """Bytes that can be had without paging: what the system calls available, or what the container's limit leaves; infinite where
    nothing is known."""
    sizes = [_of_system(), _of_container(Path("/sys/fs/cgroup"))]
    return min(sizes)


def fits(size: float) -> bool:
    """True if ``size`` bytes can be allocated."""
    return size <= SHARE * available()


def readable(size: float) -> str:
    """A size for people: "6.7 GiB"."""
    if size >= 100 * 2**30:
        return f"{size / 2**30:,.0f} GiB"
    return f"{size / 2**30:.2g} GiB" if size >= 2**30 / 10 else f"{size / 2**20:.2g} MiB"


def _of_system() -> float:
    try:
        for line in Path("/proc/meminfo").read_text().splitlines():
            if line.startswith("MemAvailable:"):
                return 1024.0 * int(line.split()[1])
    except (OSError, ValueError, IndexError):
        pass
    try:  # half of all there is, where nobody counts what is free
        return 0.5 * os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (AttributeError, OSError, ValueError):
        return float("inf")


def _of_container(folder: Path) -> float:
    try:
        limit, used = (folder / "memory.max").read_text(), (folder / "memory.current").read_text()
        return max(0.0, float(limit) - float(used))
    except (OSError, ValueError):  # no such limit, or "max"
        return float("inf")
