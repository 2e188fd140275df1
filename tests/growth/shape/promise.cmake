# A convex shape kind: its core in one file, its row and its name. A cone that stands on a plane stays where it is, by
# everything that nobody has told of cones. It is put down half a degree aslant: its twin would balance on a point.
set(at_most 3)
set(name cone)
set(targets lpc)
file(WRITE ${work}/standing_cone.toml [=[
name = "standing_cone"
summary = "a cone on its base on a plane"
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
position = [0, 0.505, 0]
angle = 1.56
shapes = [{ kind = "cone", half_height = 0.5, radius = 0.4 }]
]=])
set(proof ${bin}/lpc run ${work}/standing_cone.toml --pipeline contacts=query_clip)
set(blames "collapsed|exploded|diverged")
set(round everything)
