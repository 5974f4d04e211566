"""Data of bare programs, and of what is written as one."""
