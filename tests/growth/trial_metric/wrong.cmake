# Reads a series that no trial stores.
edit(experiments/trial/measure/world_metrics.cpp "return r.end(\"height\")" "return r.end(\"hieght\")")
