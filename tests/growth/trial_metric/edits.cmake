edit(experiments/trial/measure/world_metrics.cpp "      {{\"steps_done\"" [[
      {{"highest_end", "highest body at the end", "m", "of all bodies' centres", kDetail, ""},
       [](R r) { return r.end("height"); }},
      {{"steps_done"]])
