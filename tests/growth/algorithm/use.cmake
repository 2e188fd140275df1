# A sweep measures it against its neighbours, and what is done is not done again.
new_sweep(neighbours [[
summary = "two broadphases"
kind = "boxes"
[axes]
broadphase = "*"
dimension = 2
n = [16, 32]
frames = 3
distribution = "uniform"
]])
must_say("4 run, 0 of these not ok" ${sweep} --only counting_buckets,naive)
must_say("4 were done, 0 run" ${sweep} --only counting_buckets,naive)
