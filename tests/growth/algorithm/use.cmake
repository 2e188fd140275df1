# A sweep measures it against its neighbours, and what is done is not done again.
file(WRITE ${work}/neighbours.toml [[
summary = "two broadphases"
kind = "boxes"
[axes]
broadphase = "*"
dimension = 2
n = [16, 32]
frames = 3
distribution = "uniform"
]])
file(REMOVE ${work}/neighbours.db)
set(sweep ${bin}/lpc sweep ${work}/neighbours.toml --only counting_buckets,naive --store ${work}/neighbours.db --quiet)
must_say("4 run, 0 of these not ok" ${sweep})
must_say("4 were done, 0 run" ${sweep})
