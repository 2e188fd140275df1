must_say("\"highest_end\": ?2\\.[45]" ${proof})
# The store describes the metric, so that every report can show it.
new_sweep(measured [[
summary = "one trial"
kind = "world"
[axes]
scene = "box_drop"
steps = 2
]])
must_say("1 run, 0 of these not ok" ${sweep})
file(STRINGS ${work}/measured.db text REGEX "of all bodies' centres")
if(NOT text)
  message(FATAL_ERROR "${name}: the store does not describe it")
endif()
