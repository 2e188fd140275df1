# It loses pairs that meet in the last bucket of the first of them.
edit(algorithms/broadphase/counting_buckets.cpp "> last) break;" ">= last && last > 0) break;")
