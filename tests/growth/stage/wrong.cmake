# Increases velocities that it should not change.
edit(algorithms/speed_limit/longest_step.cpp "way > m_length" "way < m_length")
