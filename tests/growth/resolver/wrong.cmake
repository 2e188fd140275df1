# Contacts also pull.
edit(algorithms/velocity/backward.cpp "row.impulse[0] = std::max(old + row.normal.mass * (row.target - v), Real(0));"
     "row.impulse[0] = old + row.normal.mass * (row.target - v);")
