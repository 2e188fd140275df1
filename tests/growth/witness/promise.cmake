# A witness: its adapter, and its verdicts on the corpus. It answers in LPC's conventions, with measured error bars.
set(at_most 2)
set(name alternating_projections)
set(targets test_properties_f64 test_regressions_f64)
set(proof ${bin}/test_properties_f64 --gtest_filter=*EachWitness.*/alternating_projections_3)
set(blames "FAILED[^\n]* Registered/EachWitness.ErrorBarsAreMeasured/alternating_projections_3")
set(round witnesses)
