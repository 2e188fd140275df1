# The tip at both ends: nothing that it could stand on.
edit(framework/core_cone.cpp "return {-h, r * (d[1] / across), r * (d[2] / across)};" "return {d[0] < 0 ? -h : h, 0, 0};")
edit(framework/core_cone.cpp "corners.push_back({-h, y[i], z[i]})" "corners.push_back({-h, 0 * y[i], 0 * z[i]})")
