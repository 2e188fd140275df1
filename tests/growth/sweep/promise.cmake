# A sweep: one file, and nothing is compiled.
set(at_most 1)
set(name drop_iterations)
set(targets "")
set(proof ${bin}/lpc sweep drop_iterations --store ${work}/drop_iterations.db --quiet --retry)
set(blames "drop_iterations.toml:[0-9]+: axis 'stepz' is unknown")
