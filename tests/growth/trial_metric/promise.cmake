# A metric measured during trials: one entry. It changes the content of a trial, so every trial runs again.
set(at_most 1)
set(name highest_end)
set(targets lpc)
set(round everything)
set(proof ${bin}/lpc run vertical_stack --param n=3 --param gap=0 --dimension 2 --json)
set(blames "a metric reads unknown series 'hieght'; valid: .*height")
