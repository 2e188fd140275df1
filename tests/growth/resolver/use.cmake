# All commands of the guide. The shipped sweeps contain it without an edit.
follow_guide("A resolver")
foreach(part IN ITEMS "100% tests passed" "resolvers +[1-9][0-9]* trials, [1-9][0-9]* timed, 0 unsupported"
        "breaking_points_stack +[^\n]*[1-9][0-9]* cells")
  if(NOT output MATCHES "${part}")
    message(FATAL_ERROR "the guide's commands should say '${part}':\n${output}")
  endif()
endforeach()
new_sweep(resolvers_of_a_box [[
summary = "every resolver"
kind = "world"
[axes]
scene = "box_drop"
steps = 5
iterations = 4
[axes.resolver]
"$velocity" = "solver=split_solver{velocity=*{iterations=$iterations}}"
]])
must_say("1 run, 0 of these not ok" ${sweep} --only backward)
