# A joint kind: one file. Every solver supports it, scenes name it, sweeps over kinds contain it, and the tests of kinds cover it.
set(at_most 1)
set(name slider)
set(targets test_joint_f64)
set(proof ${bin}/test_joint_f64 --gtest_filter=JointConformance.EveryKind2)
set(blames "Joint.KeepsMomenta slider")
