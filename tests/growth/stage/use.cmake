# Pipelines name it, and it takes effect: 0.001 m in 1/60 s, plus the speed that gravity adds in one step.
function(max_speed out)
  must_say("max_speed +([0-9.e+-]+)" ${bin}/lpc run box_drop --steps 30 ${ARGN})
  string(REGEX MATCH "max_speed +([0-9.e+-]+)" match "${output}")
  set(${out} ${CMAKE_MATCH_1} PARENT_SCOPE)
endfunction()
max_speed(free)
max_speed(held --pipeline speed_limit=longest_step{length=0.001})
if(NOT free GREATER 1 OR NOT held LESS 0.3)
  message(FATAL_ERROR "speed_limit=longest_step{length=0.001}: ${held} m/s, without ${free} m/s")
endif()
run(result output ${bin}/lpc run box_drop --pipeline speed_limit=no_limit)
if(NOT result EQUAL 2 OR NOT output MATCHES "no speed_limit 'no_limit' in 2D; valid: longest_step")
  message(FATAL_ERROR "a wrong name in the new stage:\n${output}")
endif()
# It can be an axis of a sweep.
new_sweep(limits [[
summary = "two limits"
kind = "world"
[axes]
scene = "box_drop"
steps = 5
speed_limit = ["longest_step", "longest_step{length=0.001}"]
]])
must_say("2 run, 0 of these not ok" ${sweep})
