# Installs LPC into an empty folder and builds what a user would build against it: the programs of the manual, the plugin of the
# guide, and what stands beside this file: cmake -DSOURCE_DIR=... -DBINARY_DIR=... -DWORK_DIR=... -DCXX=... -P
cmake_minimum_required(VERSION 3.25)  # for its policies: a script has none of its own
include(${CMAKE_CURRENT_LIST_DIR}/../guide.cmake)

function(must)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${ARGN}\nended with ${result}:\n${output}")
  endif()
  message(STATUS "${output}")
  set(output "${output}" PARENT_SCOPE)
endfunction()
function(should_say)  # each is in what was said last
  foreach(part IN LISTS ARGN)
    string(FIND "${output}" "${part}" at)
    if(at EQUAL -1)
      message(FATAL_ERROR "this should say '${part}':\n${output}")
    endif()
  endforeach()
endfunction()

# A page's commands, with this build and an empty place to install to.
function(follow page heading folder)
  page_commands(${page} "${heading}" script)
  string(REPLACE "/opt/lpc" "${WORK_DIR}/prefix" script "${script}")
  string(REPLACE "--install build/release" "--install ${BINARY_DIR}" script "${script}")
  string(REPLACE "build/release/bin" "${BINARY_DIR}/bin" script "${script}")
  if(NOT EXISTS ${BINARY_DIR}/bin/lpc)
    string(REGEX REPLACE "[^\n]*/bin/lpc [^\n]*\n" "" script "${script}")
  endif()
  run_script("${script}" ${folder})
  message(STATUS "${output}")
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK_DIR})
set(ENV{CXX} ${CXX})
set(ENV{CMAKE_BUILD_TYPE} Release)
set(manual ${SOURCE_DIR}/docs/manual.md)
set(guide ${SOURCE_DIR}/docs/adding_an_algorithm.md)

foreach(file IN ITEMS main.cpp CMakeLists.txt)
  page_file(${manual} ${file} ${WORK_DIR}/manual/${file})
endforeach()
follow(${manual} "A first world in C++" ${WORK_DIR}/manual)
should_say("the box rests at height 0.495 m")

# Single stages; the same world in the other precision, and the manual's rays.
file(COPY ${CMAKE_CURRENT_LIST_DIR}/more DESTINATION ${WORK_DIR})
foreach(file IN ITEMS main.cpp ray.cpp change.cpp)
  page_file(${manual} ${file} ${WORK_DIR}/more/${file})
endforeach()
must(${CMAKE_COMMAND} -G Ninja -S ${WORK_DIR}/more -B ${WORK_DIR}/more/build -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix)
must(${CMAKE_COMMAND} --build ${WORK_DIR}/more/build)
must(${WORK_DIR}/more/build/single_stages)
must(${WORK_DIR}/more/build/ray)
should_say("body 42 at 4.0 m, normal (-1, 0)")
must(${WORK_DIR}/more/build/change)
should_say("1 contact, 3.0 m" "taken apart into 2 bodies")
if(EXISTS ${WORK_DIR}/more/build/drop_a_box_f32)
  must(${WORK_DIR}/more/build/drop_a_box_f32)
  should_say("the box rests at height 0.495 m")
endif()

# What is installed links none of the oracle libraries.
file(GLOB libraries ${WORK_DIR}/prefix/lib*/*.so ${WORK_DIR}/prefix/lib*/*/*.so)
foreach(library IN LISTS libraries)
  execute_process(COMMAND ldd ${library} OUTPUT_VARIABLE links)
  if(links MATCHES "libfcl|libccd|[Bb]ullet|libsqlite")
    message(FATAL_ERROR "${library} links an oracle library:\n${links}")
  endif()
endforeach()

# A broadphase, a resolver and a shape outside of the tree, word for word.
foreach(file IN ITEMS algorithms/broadphase/bucket_sort.cpp algorithms/velocity/backward.cpp mine/plugin.cpp mine/CMakeLists.txt
        neighbours.toml mine/dome.cpp domes.toml)
  page_file(${guide} ${file} ${WORK_DIR}/guide/${file})
endforeach()
follow(${guide} "Outside this tree" ${WORK_DIR}/guide)
if(EXISTS ${BINARY_DIR}/bin/lpc)
  should_say("equal buckets along x" "our own methods: all right" "6 run, 0 of these not ok")
  if(NOT output MATCHES "resolvers +[1-9][0-9]* trials, [1-9][0-9]* timed, 0 unsupported")
    message(FATAL_ERROR "the shipped sweep has no trials of the plugin's resolver:\n${output}")
  endif()
endif()

# The example program, and its broadphase judged as a plugin.
file(COPY ${SOURCE_DIR}/experiments/dominoes DESTINATION ${WORK_DIR}/game/experiments)
follow(${manual} "An example program" ${WORK_DIR}/game)
should_say("19 of 19 dominoes were knocked over, and the bell rang: 24 points" "0 of 19 dominoes were knocked over: 0 points")
if(EXISTS ${BINARY_DIR}/bin/lpc)
  should_say("our own methods: all right")
endif()
