# Loses the pairs in the last bucket that a box reaches.
edit(algorithms/broadphase/bucket_sort.cpp "c <= last; ++c" "c < last; ++c")
