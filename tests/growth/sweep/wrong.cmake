# An axis that nobody knows.
edit(experiments/sweeps/drop_iterations.toml "steps = 20" "stepz = 20")
