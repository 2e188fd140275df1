# It lengthens the velocities that it should leave alone.
edit(algorithms/speed_limit/longest_step.cpp "way > m_length" "way < m_length")
