# It reads a series that nobody stores.
edit(experiments/trial/measure/world_metrics.cpp "return r.end(\"height\")" "return r.end(\"hieght\")")
