# A kind of joint: one file. Every solver takes it, scenes name it, sweeps over kinds hold it, and the tests of kinds try it.
set(at_most 1)
set(name slider)
set(targets test_joint_f64)
set(proof ${bin}/test_joint_f64 --gtest_filter=JointConformance.EveryKind2)
set(blames "Joint.KeepsMomenta slider")
