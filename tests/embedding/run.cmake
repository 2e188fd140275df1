# Installs LPC into an empty folder and builds what a user would build against it: cmake -DBINARY_DIR=... -DWORK_DIR=... -P
function(must)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${ARGN}\nended with ${result}:\n${output}")
  endif()
  message(STATUS "${output}")
endfunction()

file(REMOVE_RECURSE ${WORK_DIR})
must(${CMAKE_COMMAND} --install ${BINARY_DIR} --prefix ${WORK_DIR}/prefix --component lpc)
foreach(consumer world stages plugin)
  must(${CMAKE_COMMAND} -G Ninja -S ${CMAKE_CURRENT_LIST_DIR}/${consumer} -B ${WORK_DIR}/${consumer}
       -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix -DCMAKE_CXX_FLAGS=${CXX_FLAGS} -DCMAKE_BUILD_TYPE=Release)
  must(${CMAKE_COMMAND} --build ${WORK_DIR}/${consumer})
endforeach()
file(GLOB programs ${WORK_DIR}/world/drop_a_box_lpc* ${WORK_DIR}/stages/single_stages)
foreach(program IN LISTS programs)
  if(NOT IS_DIRECTORY ${program})
    must(${program})
  endif()
endforeach()

# What is installed links none of the oracle libraries.
file(GLOB libraries ${WORK_DIR}/prefix/lib*/*.so ${WORK_DIR}/prefix/lib*/*/*.so)
foreach(library IN LISTS libraries)
  execute_process(COMMAND ldd ${library} OUTPUT_VARIABLE links)
  if(links MATCHES "libfcl|libccd|[Bb]ullet|libsqlite")
    message(FATAL_ERROR "${library} links an oracle library:\n${links}")
  endif()
endforeach()

# The plugin is listed, and refused when its ABI differs.
if(EXISTS ${BINARY_DIR}/bin/lpc)
  execute_process(COMMAND ${BINARY_DIR}/bin/lpc --plugin ${WORK_DIR}/plugin/libbucket.so list
                  RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0 OR NOT output MATCHES "bucket_sort")
    message(FATAL_ERROR "lpc --plugin ... list ended with ${result} and does not show bucket_sort:\n${output}")
  endif()
endif()
