edit(framework/stages.h "sleep, engine }" "sleep, engine, speedLimit }")
edit(framework/stages.h [[    {StageKind::engine, "engine", "engine", ""},
]] [[    {StageKind::engine, "engine", "engine", ""},
    {StageKind::speedLimit, "speed_limit", "speed_limit", "longest_step"},
]])
edit(framework/world_step.cpp [[#include "framework/world.h"
]] [[#include "framework/world.h"
#include "framework/stage_speed_limit.h"
]])
edit(framework/world_step.cpp "    stage<Solver>().step(" "    stage<SpeedLimit>().limit(dt, m_bodies);
    stage<Solver>().step(")
