edit(framework/stage/stages.h "  engine
}" "  engine,
  speedLimit
}")
edit(framework/stage/stages.h [[    {StageKind::engine, "engine", "engine", ""},
]] [[    {StageKind::engine, "engine", "engine", ""},
    {StageKind::speedLimit, "speed_limit", "speed_limit", "longest_step"},
]])
edit(framework/world/world_step.cpp [[#include "framework/world/world.h"
]] [[#include "framework/world/world.h"
#include "framework/stage/stage_speed_limit.h"
]])
edit(framework/world/world_step.cpp "    stage<Solver>().step(" "    stage<SpeedLimit>().limit(dt, m_table.bodies);
    stage<Solver>().step(")
