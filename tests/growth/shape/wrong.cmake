# Only tips: no side to lie on.
edit(framework/shape/core_bicone.cpp "return {0, r * (y / across), r * (z / across)};" "return {d[0] < 0 ? -h : h, 0, 0};")
edit(framework/shape/core_bicone.cpp "corners.push_back({0, r * (d[1] / across), r * (d[2] / across)});" "corners.push_back({0, 0, 0});")
