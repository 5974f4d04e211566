"""A process that starts runs as on systems where forking is unsafe."""

from waybound.reports.campaigns import fork_server


def main(descriptor: int, folder: str) -> None:
    """Do each run in a fresh interpreter."""
    fork_server.FORKS = False
    fork_server.main(descriptor, folder)
