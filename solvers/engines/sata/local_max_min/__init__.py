"""The local algorithm for max-min linear programs of robots: one version over arrays, one in which robots send messages.

Modules named ``*_kernels`` compile on import, through numba: they are imported inside functions only.
"""
