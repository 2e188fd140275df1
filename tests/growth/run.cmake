# Growth, done: each folder beside this file is a promise of what one more thing costs. Its files are put into a scratch
# tree and counted; the tree is built; the thing is listed and proved; its broken twin is caught; and when it is gone,
# lists and keys of results are as before. Pinned histories at -O0 are then compared by ctest.
#   cmake -DSOURCE_DIR=... -DWORK_DIR=... -DLAUNCHER=... [-DALL=ON] -P run.cmake
#
# A promise has
#   promise.cmake  at_most (files), name (shown by `lpc list`), targets, proof (a command that passes, and fails with
#                  `blames` in its output for the twin), rebuilds_all (ON when it edits what everything includes)
#   tree/          its new files, where they stand in the project
#   edits.cmake    edit() of files that are there, which count, too; optional
#   wrong.cmake    edit() that makes the twin
#   use.cmake      what else must work; optional
function(run out_result out_output)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  set(${out_result} ${result} PARENT_SCOPE)
  set(${out_output} "${output}" PARENT_SCOPE)
endfunction()
function(must_say what)  # the command passes, and its output matches
  run(result output ${ARGN})
  if(NOT result EQUAL 0 OR NOT output MATCHES "${what}")
    message(FATAL_ERROR "${ARGN}\nended with ${result} and should say '${what}':\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()
function(build)
  must_say("" ${CMAKE_COMMAND} --build ${work}/build --target ${ARGN})
endfunction()
function(edit file old new)
  file(READ ${tree}/${file} text)
  string(FIND "${text}" "${old}" first)
  string(FIND "${text}" "${old}" last REVERSE)
  if(first EQUAL -1 OR NOT first EQUAL last)
    message(FATAL_ERROR "${promise}: ${file} should hold once:\n${old}")
  endif()
  string(REPLACE "${old}" "${new}" text "${text}")
  file(WRITE ${tree}/${file} "${text}")
  set_property(GLOBAL APPEND PROPERTY edited_${promise} ${file})
endfunction()

function(put promise)
  include(${here}/${promise}/promise.cmake)
  file(GLOB_RECURSE new RELATIVE ${here}/${promise}/tree ${here}/${promise}/tree/*)
  foreach(file IN LISTS new)
    if(EXISTS ${tree}/${file})
      message(FATAL_ERROR "${promise}: ${file} is there already")
    endif()
  endforeach()
  file(COPY ${here}/${promise}/tree/ DESTINATION ${tree})
  include(${here}/${promise}/edits.cmake OPTIONAL)
  get_property(edited GLOBAL PROPERTY edited_${promise})
  set(files ${new} ${edited})
  list(REMOVE_DUPLICATES files)
  list(LENGTH files count)
  message(STATUS "${promise} ${name}: ${count} of ${at_most} files: ${files}")
  if(count GREATER at_most)
    message(FATAL_ERROR "${promise}: it costs ${count} files; the promise is ${at_most}")
  endif()
endfunction()

function(take promise)
  file(GLOB_RECURSE new RELATIVE ${here}/${promise}/tree ${here}/${promise}/tree/*)
  foreach(file IN LISTS new)
    file(REMOVE ${tree}/${file})
    cmake_path(GET file PARENT_PATH folder)
    if(NOT EXISTS ${SOURCE_DIR}/${folder})
      file(REMOVE_RECURSE ${tree}/${folder})
    endif()
  endforeach()
  get_property(edited GLOBAL PROPERTY edited_${promise})
  foreach(file IN LISTS edited)
    if(EXISTS ${SOURCE_DIR}/${file})
      configure_file(${SOURCE_DIR}/${file} ${tree}/${file} COPYONLY)
    endif()
  endforeach()
endfunction()

function(prove promise)
  include(${here}/${promise}/promise.cmake)
  must_say("[ \n]${name}[ \n]" ${bin}/lpc list)
  must_say("" ${proof})
  include(${here}/${promise}/use.cmake OPTIONAL)

  include(${here}/${promise}/wrong.cmake)
  if(targets)
    build(${targets})
  endif()
  run(result output ${proof})
  if(result EQUAL 0 OR NOT output MATCHES "${blames}")
    message(FATAL_ERROR "${promise}: the broken twin of ${name} is not caught by\n${proof}\n${output}")
  endif()
  message(STATUS "${promise} ${name}: its broken twin is caught")
endfunction()

function(as_before)
  build(lpc)
  must_say("" ${bin}/lpc list)
  if(NOT output STREQUAL list_before)
    message(FATAL_ERROR "lpc list is not as before:\n${output}")
  endif()
  must_say("6 were done, 0 run" ${keys})
endfunction()

set(here ${CMAKE_CURRENT_LIST_DIR})
set(work ${WORK_DIR})
set(tree ${work}/tree)
set(bin ${work}/build/bin)
set(ENV{LPC_TEST_CASES} 3)  # long histories, without optimisation

# The build folder stays between runs, the sources are copied again: only what changed is compiled. Not after a run that
# was stopped: copies are as old as their originals, so an object made of an edited file would seem fresh.
if(EXISTS ${work}/unfinished)
  file(REMOVE_RECURSE ${tree} ${work}/build)
endif()
file(MAKE_DIRECTORY ${work})
file(TOUCH ${work}/unfinished)
file(GLOB_RECURSE copies RELATIVE ${tree} ${tree}/*)
foreach(file IN LISTS copies)
  if(NOT EXISTS ${SOURCE_DIR}/${file})
    file(REMOVE ${tree}/${file})
  endif()
endforeach()
foreach(part framework algorithms oracles experiments tests docs CMakeLists.txt)
  file(COPY ${SOURCE_DIR}/${part} DESTINATION ${tree})
endforeach()
file(GLOB folders RELATIVE ${here} ${here}/*/promise.cmake)
list(TRANSFORM folders REPLACE "/promise.cmake" "")
must_say("" ${CMAKE_COMMAND} -G Ninja -S ${tree} -B ${work}/build -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS=-O0
         -DCMAKE_CXX_FLAGS_DEBUG= -DLPC_PRECISIONS=f64 -DLPC_BUILD_TESTS=ON -DLPC_BUILD_ORACLES=OFF
         -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER})
build(lpc)
must_say("" ${bin}/lpc list)
set(list_before "${output}")
file(WRITE ${work}/keys.toml [[
summary = "results that stay what they are"
kind = "world"
[axes]
scene = ["box_drop", "pendulum"]
broadphase = ["naive", "sort_and_sweep", "uniform_grid"]
steps = 5
]])
file(REMOVE ${work}/keys.db)
set(keys ${bin}/lpc sweep ${work}/keys.toml --store ${work}/keys.db --quiet)
must_say("6 run, 0 of these not ok" ${keys})

# First what compiles a file or none, then what compiles everything: with -DALL=ON only.
set(rounds OFF)
if(ALL)
  list(APPEND rounds ON)
endif()
foreach(round IN LISTS rounds)
  set(promises "")
  set(wanted lpc)
  foreach(promise IN LISTS folders)
    set(rebuilds_all OFF)
    include(${here}/${promise}/promise.cmake)
    if(rebuilds_all STREQUAL round)
      list(APPEND promises ${promise})
      list(APPEND wanted ${targets})
    endif()
  endforeach()
  foreach(promise IN LISTS promises)
    put(${promise})
  endforeach()
  list(REMOVE_DUPLICATES wanted)
  build(${wanted})
  if(NOT round)
    must_say("6 were done, 0 run" ${keys})  # new files change no key
  endif()
  foreach(promise IN LISTS promises)
    prove(${promise})
  endforeach()
  foreach(promise IN LISTS promises)
    take(${promise})
  endforeach()
  as_before()
endforeach()
build(determinism_f64)  # for the test that compares the pinned histories at -O0
file(REMOVE ${work}/unfinished)
