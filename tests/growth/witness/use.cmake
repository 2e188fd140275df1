# Its verdicts are the pinned ones, and sweeps accept it.
must_say("PASSED" ${bin}/test_regressions_f64 --gtest_filter=Corpus.VerdictsAreThePinnedOnes)
new_sweep(witness [[
summary = "a new witness"
kind = "pairs"
[axes]
dimension = 3
kind_a = "sphere"
kind_b = "capsule"
n = 6
pair_query = "alternating_projections"
]])
must_say("1 run, 0 of these not ok" ${sweep})
