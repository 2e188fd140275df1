# All commands of the guide. Finished trials do not run again.
follow_guide("In ten minutes: a broadphase")
foreach(part IN ITEMS "equal buckets along x" "100% tests passed" "6 run, 0 of these not ok")
  if(NOT output MATCHES "${part}")
    message(FATAL_ERROR "the guide's commands should say '${part}':\n${output}")
  endif()
endforeach()
must_say("6 were done, 0 run" ${bin}/lpc sweep ${guide_folder}/neighbours.toml --only bucket_sort,naive
         --store ${guide_folder}/results/mine.db)
