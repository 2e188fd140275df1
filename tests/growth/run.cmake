# Tests how LPC grows: each folder beside this file promises how many files an extension takes. The files are put into a scratch
# tree and counted, and the tree is built. The extension must be listed and pass its proof, and the proof must catch a planted
# bug. After removal, lists and keys of results are as before. Then ctest compares the pinned histories at -O0.
#   cmake -DSOURCE_DIR=... -DWORK_DIR=... -DLAUNCHER=... [-DPYTHON=...] [-DALL=ON] [-DONLY=...] -P run.cmake
# PYTHON: one that can make reports; ONLY: a list of promises.
#
# A promise has
#   promise.cmake  at_most (files), name (shown by `listed`; default `lpc list`), targets, proof (a command that passes; with the
#                  planted bug it fails with `blames` in its output), round (below; default `few`), needs_python
#   tree/          its new files, at their paths in the project; optional. Or, in promise.cmake, `guide`: a file of
#                  docs/adding_an_algorithm.md
#   edits.cmake    edit() of existing files, which count as well; optional
#   wrong.cmake    edit() that plants a bug
#   use.cmake      what else must work; optional
cmake_minimum_required(VERSION 3.25)  # sets policies, which a script lacks otherwise

include(${CMAKE_CURRENT_LIST_DIR}/../guide.cmake)

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
function(new_sweep name text)  # `sweep`: the command that runs it into an empty store
  file(WRITE ${work}/${name}.toml "${text}")
  file(REMOVE ${work}/${name}.db)
  set(sweep ${bin}/lpc sweep ${work}/${name}.toml --store ${work}/${name}.db --quiet PARENT_SCOPE)
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

# The new files of a promise.
function(new_files promise out)
  set(guide "")
  include(${here}/${promise}/promise.cmake)
  file(GLOB_RECURSE new RELATIVE ${here}/${promise}/tree ${here}/${promise}/tree/*)
  set(${out} ${new} ${guide} PARENT_SCOPE)
endfunction()

# Runs the guide's commands under a heading, in a separate folder, with the existing build. `output`: their output.
function(follow_guide heading)
  page_file(${guide_page} neighbours.toml ${guide_folder}/neighbours.toml)
  file(REMOVE ${guide_folder}/results/mine.db)
  page_commands(${guide_page} "${heading}" script)
  string(REPLACE "cmake --preset test && cmake --build --preset test --target lpc test_conformance_f64\n" "" script "${script}")
  string(REPLACE "build/test/bin" "${bin}" script "${script}")
  string(REPLACE "--test-dir build/test" "--test-dir ${work}/build" script "${script}")
  if(NOT PYTHON)
    string(REGEX REPLACE "[^\n]*lpc report [^\n]*\n" "" script "${script}")
  endif()
  run_script("${script}" ${guide_folder})
  set(output "${output}" PARENT_SCOPE)
endfunction()

function(put promise)
  set(guide "")
  include(${here}/${promise}/promise.cmake)
  new_files(${promise} new)
  foreach(file IN LISTS new)
    if(EXISTS ${tree}/${file})
      message(FATAL_ERROR "${promise}: ${file} is there already")
    endif()
  endforeach()
  if(guide)
    page_file(${guide_page} ${guide} ${tree}/${guide})
  elseif(new)
    file(COPY ${here}/${promise}/tree/ DESTINATION ${tree})
  endif()
  foreach(file IN LISTS new)
    file(TOUCH ${tree}/${file})  # newer than the object of the last run's planted bug
  endforeach()
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
  new_files(${promise} new)
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
  set(listed ${bin}/lpc list)
  include(${here}/${promise}/promise.cmake)
  must_say("[ \n]${name}[ \n]" ${listed})
  must_say("" ${proof})
  include(${here}/${promise}/use.cmake OPTIONAL)
endfunction()
function(catch_twin promise)
  set(needs_python OFF)
  include(${here}/${promise}/promise.cmake)
  include(${here}/${promise}/wrong.cmake)
  if(targets)
    build(${targets})
  endif()
  run(result output ${proof})
  if(result EQUAL 0 OR NOT output MATCHES "${blames}")
    message(FATAL_ERROR "${promise}: the broken twin of ${name} is not caught by\n${proof}\n${output}")
  endif()
  message(STATUS "${promise} ${name}: its broken twin is caught")
  if(needs_python)
    take(${promise})  # its planted bug would spoil the other reports
  endif()
endfunction()

function(same_keys)
  must_say("6 were done, 0 run" ${worlds})
  must_say("4 were done, 0 run" ${pairs})
endfunction()
function(as_before)
  build(lpc)
  must_say("" ${bin}/lpc list)
  if(NOT output STREQUAL list_before)
    message(FATAL_ERROR "lpc list is not as before:\n${output}")
  endif()
  same_keys()
endfunction()

set(here ${CMAKE_CURRENT_LIST_DIR})
set(work ${WORK_DIR})
set(tree ${work}/tree)
set(bin ${work}/build/bin)
set(guide_page ${SOURCE_DIR}/docs/adding_an_algorithm.md)
set(guide_folder ${work}/guide)
set(ENV{LPC_TEST_CASES} 3)  # histories are long and code is not optimised

# The build folder stays between runs and the sources are copied again, so only changes are compiled. After an interrupted run
# both are deleted: copies have their originals' times, so an object made from an edited file would seem up to date.
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
foreach(part framework algorithms oracles experiments reports tests docs CMakeLists.txt)
  file(COPY ${SOURCE_DIR}/${part} DESTINATION ${tree})
endforeach()
file(GLOB folders RELATIVE ${here} ${here}/*/promise.cmake)
list(TRANSFORM folders REPLACE "/promise.cmake" "")
new_sweep(worlds [[
summary = "results that stay what they are"
kind = "world"
[axes]
scene = ["box_drop", "pendulum"]
broadphase = ["naive", "sort_and_sweep", "uniform_grid"]
steps = 5
]])
set(worlds ${sweep})

# few: promises that compile at most one file. witnesses: with the oracles, which this tree lacks otherwise.
# everything: changes of headers that every file includes, with the oracles. The last two only with -DALL=ON, and then without
# precompiled headers, so that each file must include what it uses.
set(rounds few)
set(precompiled_off OFF)
if(ALL)
  list(APPEND rounds witnesses everything)
  set(precompiled_off ON)
endif()
foreach(current IN LISTS rounds)
  set(oracles OFF)
  set(methods "\"gjk_epa\", \"closed_form\"")
  if(NOT current STREQUAL few)
    set(oracles ON)
    set(methods "\"gjk_epa\", \"libccd_gjk\"")
  endif()
  must_say("" ${CMAKE_COMMAND} -G Ninja -S ${tree} -B ${work}/build -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS=-O0
           -DCMAKE_CXX_FLAGS_DEBUG= -DLPC_PRECISIONS=f64 -DLPC_BUILD_TESTS=ON -DLPC_BUILD_ORACLES=${oracles}
           -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER} -DCMAKE_DISABLE_PRECOMPILE_HEADERS=${precompiled_off})
  build(lpc)
  must_say("" ${bin}/lpc list)
  set(list_before "${output}")
  must_say(", 0 of these not ok" ${worlds})
  new_sweep(pairs "
summary = \"errors before the referee\"
kind = \"pairs\"
[axes]
dimension = 3
kind_a = \"sphere\"
kind_b = [\"capsule\", \"box\"]
n = 6
pair_query = [${methods}]
")
  set(pairs ${sweep})
  must_say("4 run" ${pairs})
  if(NOT oracles)  # there is no referee, and each row says so
    file(STRINGS ${work}/pairs.db text)
    string(REGEX MATCHALL "unsupportedthis build has no referee" rows "${text}")
    list(LENGTH rows count)
    if(NOT count EQUAL 4)
      message(FATAL_ERROR "${count} of 4 trials of pairs without the oracles are unsupported:\n${text}")
    endif()
  endif()

  set(promises "")
  set(wanted lpc)
  foreach(promise IN LISTS folders)
    set(round few)
    set(needs_python OFF)
    include(${here}/${promise}/promise.cmake)
    if(needs_python AND NOT PYTHON)
      message(STATUS "${promise} ${name}: not tested, there is no Python that can make reports")
    elseif(round STREQUAL current AND (NOT ONLY OR promise IN_LIST ONLY))
      list(APPEND promises ${promise})
      list(APPEND wanted ${targets})
    endif()
  endforeach()
  foreach(promise IN LISTS promises)
    put(${promise})
  endforeach()
  list(REMOVE_DUPLICATES wanted)
  build(${wanted})
  if(NOT current STREQUAL everything)
    same_keys()  # new files change no key
  endif()
  foreach(promise IN LISTS promises)
    prove(${promise})
  endforeach()
  foreach(promise IN LISTS promises)  # after all proofs: the planted bug of a stage spoils every step
    catch_twin(${promise})
  endforeach()
  foreach(promise IN LISTS promises)
    take(${promise})
  endforeach()
  as_before()
endforeach()
build(determinism_f64)  # for the test that compares the pinned histories at -O0
file(REMOVE ${work}/unfinished)
