# A convex shape kind: its core in one file, its row and its name. A bicone lying on its side on a plane stays in place, with
# code that does not mention bicones. It starts tilted by half a degree: the planted bug has no side to lie on.
set(at_most 3)
set(name bicone)
set(targets lpc)
file(WRITE ${work}/lying_bicone.toml [=[
name = "lying_bicone"
summary = "a bicone on its side on a plane"
dimensions = [3]
needs = ["cache", "friction", "rotation"]
steps = 300
[limits]
drift = 0.02
speed = 10
[[body]]
type = "fixed"
shapes = [{ kind = "plane" }]
[[body]]
position = [0, 0.316, 0]
angle = -0.666
shapes = [{ kind = "bicone", half_length = 0.5, radius = 0.4 }]
]=])
set(proof ${bin}/lpc run ${work}/lying_bicone.toml --pipeline contacts=query_clip)
set(blames "collapsed|exploded|diverged")
set(round everything)
