# The shipped sweeps have it, and nobody has told them.
must_say("resolvers +[1-9][0-9]* trials, [1-9][0-9]* timed, 0 unsupported" ${bin}/lpc sweep resolvers --only backward --dry-run)
must_say("breaking_points_stack +[1-9][0-9]* trials" ${bin}/lpc sweep breaking_points_stack --only backward --dry-run)
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
