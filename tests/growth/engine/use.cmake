# A sweep names it in place of a pipeline, and the row lists the settings that it lacks.
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
