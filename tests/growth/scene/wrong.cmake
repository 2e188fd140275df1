# The boxes start one step too low, inside the stairs.
edit(experiments/scenes/stairs.toml "(i + 1) * rise + 0.3" "i * rise + 0.3")
