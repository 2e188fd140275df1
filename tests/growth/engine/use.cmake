# It stands in a sweep where a pipeline stands, and what it cannot set alike stands in the row.
new_sweep(engines [[
summary = "a new engine"
kind = "world"
[axes]
scene = "vertical_stack"
dimension = 2
steps = 30
engine = "inner_world"
]])
must_say("1 run, 0 of these not ok" ${sweep})
