# Distances are 1 % too large.
edit(oracles/witnesses/alternating_projections.cpp "apart - m_radiusA" "1.01 * apart - m_radiusA")
