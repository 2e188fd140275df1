# A velocity resolver: one file.
set(at_most 1)
set(name backward)
set(targets test_velocity_f64)
set(proof ${bin}/test_velocity_f64 --gtest_filter=VelocityConformance.EveryResolver*)
set(blames "property: Impulse.PushesOnly backward")
