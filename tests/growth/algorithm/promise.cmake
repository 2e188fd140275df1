# An algorithm: one file (docs/adding_an_algorithm.md).
set(at_most 1)
set(name counting_buckets)
set(targets test_broadphase_f64)
set(proof ${bin}/test_broadphase_f64 --gtest_filter=BroadphasePairs.*)
set(blames "pairs of counting_buckets are those of brute force")
