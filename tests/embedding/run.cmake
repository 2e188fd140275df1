# Installs LPC into an empty folder and builds what a user would build against it: the programs of the manual, the plugin of the
# guide, and what stands beside this file: cmake -DSOURCE_DIR=... -DBINARY_DIR=... -DWORK_DIR=... -DCXX=... [-DLAUNCHER=...]
# [-DPART=programs, or extensions: the plugin, the dominoes and the window] [-DDEEP=ON] -P. Headers take most of the time:
# everything is compiled without optimisation, and the programs of the pages as one file. With DEEP the other files are compiled
# by themselves, as Release.
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
  # A window would wait for somebody to close it.
  string(REPLACE "build/view/tower\n" "env -u DISPLAY -u WAYLAND_DISPLAY build/view/tower || [ $? = 2 ]\n" script "${script}")
  if(NOT DEEP)
    string(REPLACE " -DCMAKE_BUILD_TYPE=Release" "" script "${script}")
    string(REPLACE " -DCMAKE_PREFIX_PATH" " -DCMAKE_UNITY_BUILD=ON -DCMAKE_PREFIX_PATH" script "${script}")
    string(REPLACE "--pairs 20" "--metamorphic --pairs 10" script "${script}")  # as the page has it a block of 200 is asked
  endif()
  if(NOT EXISTS ${BINARY_DIR}/bin/lpc)
    string(REGEX REPLACE "[^\n]*/bin/lpc [^\n]*\n" "" script "${script}")
  endif()
  run_script("${script}" ${folder})
  message(STATUS "${output}")
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK_DIR})
set(ENV{CXX} ${CXX})
set(ENV{CMAKE_CXX_COMPILER_LAUNCHER} "${LAUNCHER}")
if(DEEP)
  set(ENV{CMAKE_BUILD_TYPE} Release)
else()
  set(ENV{CXXFLAGS} "-O0 -DNDEBUG")  # what is installed is Release
endif()
set(manual ${SOURCE_DIR}/docs/manual.md)
set(reference ${SOURCE_DIR}/docs/reference_world.md)
set(guide ${SOURCE_DIR}/docs/adding_an_algorithm.md)

if(NOT PART STREQUAL extensions)

foreach(file IN ITEMS main.cpp CMakeLists.txt)
  page_file(${manual} ${file} ${WORK_DIR}/manual/${file})
endforeach()
follow(${manual} "A first world in C++" ${WORK_DIR}/manual)
should_say("the box rests at height 0.495 m")

# Single stages, the manual's other programs and the pages of parts are one program, to be compiled at once: each is a function, and
# the main function calls them in their order. The same world in the other precision is a second one.
file(COPY ${CMAKE_CURRENT_LIST_DIR}/more DESTINATION ${WORK_DIR})
page_file(${manual} main.cpp ${WORK_DIR}/more/main.cpp)
file(READ ${CMAKE_CURRENT_LIST_DIR}/more/single_stages.cpp program)
set(wanted "1 pair(s), distance -0.200 m")
foreach(name IN ITEMS ray change forces drawing)
  page_file(${reference} ${name}.cpp ${WORK_DIR}/manual/${name}.cpp)
  file(READ ${WORK_DIR}/manual/${name}.cpp part)
  string(REPLACE "\nint main() {" "\nvoid ${name}OfTheManual() {" part "${part}")
  string(APPEND program "${part}\n")
  list(APPEND parts ${WORK_DIR}/manual/${name}.cpp)
endforeach()
list(APPEND wanted "body 42 at 4.0 m, normal (-1, 0)" "1 contact, 3.0 m" "taken apart into 2 bodies" "the ball hangs at 0.615 m"
     "a box at height -0.5 that is fixed" "a box at height 0.5 that moves" "an impulse of 0.082 N s"
     "a contact at x = 0.5 that bears")
set(pages_print "")
foreach(name IN ITEMS shapes joints forces listeners)
  set(page ${SOURCE_DIR}/docs/${name}.md)
  page_file(${page} ${name}.cpp ${WORK_DIR}/pages/${name}.cpp)
  file(READ ${WORK_DIR}/pages/${name}.cpp part)
  string(APPEND program "${part}\n")
  page_prints(${page} said)
  string(APPEND pages_print "${said}")
  list(APPEND parts ${WORK_DIR}/pages/${name}.cpp)
endforeach()
# An include that a part lacks is not missed, since an earlier part has it: so each part is asked for those that its words need.
foreach(file IN LISTS parts)
  file(READ ${file} part)
  foreach(need IN ITEMS "World<|lpc/world.h" "std::(printf|puts)|cstdio" "drawSimulation|lpc/draw_simulation.h"
          "Between|lpc/shape_between.h" "CurvedBase|lpc/curved_core.h" "std::(abs|sqrt|sin|cos|atan2|hypot)\\(|cmath"
          "std::(max|min|clamp)|algorithm" "std::(make_unique|make_shared|unique_ptr)|memory" "std::array|array"
          "std::vector|vector")
    string(REGEX REPLACE "^(.*)\\|[^|]*$" "\\1" words "${need}")
    string(REGEX REPLACE "^.*\\|" "" header "${need}")
    if(part MATCHES "${words}" AND NOT part MATCHES "#include <${header}>")
      message(FATAL_ERROR "${file} needs #include <${header}>")
    endif()
  endforeach()
endforeach()
string(REGEX MATCHALL "\nvoid [A-Za-z]+\\(\\) {" shown "${program}")
string(REGEX REPLACE "void ([A-Za-z]+\\(\\)) {;?" "  \\1;" calls "${shown}")
file(WRITE ${WORK_DIR}/more/pages.cpp "${program}int main() {${calls}\n}\n")
must(${CMAKE_COMMAND} -G Ninja -S ${WORK_DIR}/more -B ${WORK_DIR}/more/build -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix)
must(${CMAKE_COMMAND} --build ${WORK_DIR}/more/build)
must(${WORK_DIR}/more/build/pages)
should_say(${wanted})
string(FIND "${output}" "${pages_print}" at)
string(LENGTH "${output}" whole)
string(LENGTH "${pages_print}" end)
math(EXPR end "${at} + ${end}")
if(at EQUAL -1 OR NOT end EQUAL whole)
  message(FATAL_ERROR "the pages say that their programs print\n${pages_print}and the end of what is printed is\n${output}")
endif()
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

endif()
if(PART STREQUAL programs)
  return()
endif()

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
follow(${reference} "An example program" ${WORK_DIR}/game)
should_say("19 of 19 dominoes were knocked over, and the bell rang: 24 points" "0 of 19 dominoes were knocked over: 0 points")
if(EXISTS ${BINARY_DIR}/bin/lpc)
  should_say("our own methods: all right")
endif()

# The program with a window, where its packages are: it is built, and says that there is no display. What windows show is tested by
# tests/sandbox.
if(EXISTS ${BINARY_DIR}/experiments/sandbox/liblpc_window.a)
  file(COPY ${SOURCE_DIR}/experiments/view DESTINATION ${WORK_DIR}/view/experiments)
  follow(${reference} "A world in a window" ${WORK_DIR}/view)
  should_say("no window: SDL says 'x11 not available'; valid: a display, such as DISPLAY=:0")
endif()
