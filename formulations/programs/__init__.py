"""Programs: arrays, cones, exactness, reductions and exports."""
