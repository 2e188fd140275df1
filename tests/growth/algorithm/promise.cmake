# An algorithm: one file, the example of the guide.
set(at_most 1)
set(guide algorithms/broadphase/bucket_sort.cpp)
set(name bucket_sort)
set(targets test_broadphase_f64)
set(proof ${bin}/test_broadphase_f64 --gtest_filter=BroadphasePairs.*)
set(blames "pairs of bucket_sort are those of brute force")
