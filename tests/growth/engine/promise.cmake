# An engine: its adapter. Bodies fall, slide, collide and carry others as in every engine.
set(at_most 1)
set(name inner_world)
set(targets lpc-engine-worker-f64 test_engines_f64)
set(proof ${bin}/test_engines_f64 --gtest_filter=Engines.BallsFall:Engines.StacksRest:Engines.ForcesAct)
set(blames "inner_world 2D: falls")
set(round witnesses)
