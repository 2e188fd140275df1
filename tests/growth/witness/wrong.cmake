# One part in a hundred too far.
edit(oracles/witnesses/alternating_projections.cpp "apart - m_radiusA" "1.01 * apart - m_radiusA")
