# Applies the torque to B but not to A.
edit(algorithms/joint/slider.cpp "out.turn(Ang<D>::Unit(i), turn[i]);" "out.turn(Ang<D>::Unit(i), turn[i]).armA.setZero();")
