# A scene that names it runs, and its key includes the joint's file.
file(WRITE ${work}/rail.toml [=[
name = "rail"
summary = "a box slides down a rail that leans by 45 degrees"
dimensions = [2, 3]
needs = ["joints", "rotation"]
gravity = [0, -10, 0]
steps = 60
[[body]]
name = "sled"
position = [0, 0, 0]
angle = -0.7853981633974483
shapes = [{ kind = "box", half = [0.2, 0.1, 0.1] }]
[[joint]]
kind = "slider"
a = "world"
b = "sled"
anchor = [0, 0, 0]
]=])
must_say("outcome +ok" ${bin}/lpc run ${work}/rail.toml)
# Scenes with the joint kind as a parameter accept it, and the shipped sweep contains it without an edit.
must_say("outcome +ok" ${bin}/lpc run bridge --param joint=slider --steps 5)
must_say("joints +[1-9][0-9]* trials, [1-9][0-9]* timed, 0 unsupported" ${bin}/lpc sweep joints --only slider --dry-run)
