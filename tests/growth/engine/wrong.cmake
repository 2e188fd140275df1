# Reverses gravity.
edit(oracles/engines/inner_world.cpp "inner.gravity *= Real(1);" "inner.gravity *= Real(-1);")
