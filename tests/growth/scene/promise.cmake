# A scene: one file, and nothing is compiled. Its limits state what must hold.
set(at_most 1)
set(name stairs)
set(targets "")
set(proof ${bin}/lpc run stairs)
set(blames "collapsed|exploded")
