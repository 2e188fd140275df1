# A stage: its interface, its row in the list, its first algorithm, and the place in the world that calls it. Its default
# changes no history: the pinned ones are the proof.
set(at_most 4)
set(name speed_limit)
set(targets determinism_f64)
set(proof ${bin}/determinism_f64 --pinned ${tree}/tests/determinism/pinned_hashes.txt)
set(blames "pinned")
set(round everything)
