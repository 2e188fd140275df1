# A velocity resolver built on the solvers' kernels: one file, the example of the guide.
set(at_most 1)
set(guide algorithms/velocity/backward.cpp)
set(name backward)
set(targets test_velocity_f64)
set(proof ${bin}/test_velocity_f64 --gtest_filter=VelocityConformance.EveryResolver*)
set(blames "property: Impulse.PushesOnly backward")
