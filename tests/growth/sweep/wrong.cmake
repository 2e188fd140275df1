# An unknown axis.
edit(experiments/sweeps/drop_iterations.toml "steps = 20" "stepz = 20")
