# A stage: its interface, its row in the list, its first algorithm, and its call in the world. Its default changes no result, as
# the pinned histories show.
set(at_most 4)
set(name speed_limit)
set(targets determinism_f64)
set(proof ${bin}/determinism_f64 --pinned ${tree}/tests/determinism/pinned_hashes.txt)
set(blames "pinned")
set(round everything)
