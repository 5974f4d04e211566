"""First-order methods for max-min linear programs of robots and targets, and linear programs where they fall short.

Modules named ``*_kernels`` compile on import, through numba: they are imported inside functions only.
"""
