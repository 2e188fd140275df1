# The newcomer's ten minutes (docs/adding_an_algorithm.md), done: one new file, no other edit, and the algorithm is listed,
# proved by the conformance tests, swept, and in the store. A wrong one is caught.
# cmake -DSOURCE_DIR=... -DWORK_DIR=... -DLAUNCHER=... -P ten_minutes.cmake
function(run out_result out_output)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  set(${out_result} ${result} PARENT_SCOPE)
  set(${out_output} "${output}" PARENT_SCOPE)
endfunction()
function(must)
  run(result output ${ARGN})
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${ARGN}\nended with ${result}:\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

# The build folder stays between runs, the sources are copied again: only what changed is compiled.
file(MAKE_DIRECTORY ${WORK_DIR})
set(tree ${WORK_DIR}/tree)
file(REMOVE ${WORK_DIR}/store.db)
foreach(folder framework algorithms oracles experiments tests docs)
  file(COPY ${SOURCE_DIR}/${folder} DESTINATION ${tree})
endforeach()
foreach(file CMakeLists.txt)
  file(COPY ${SOURCE_DIR}/${file} DESTINATION ${tree})
endforeach()

# Step 1 and 2: the naive broadphase under another name.
file(READ ${SOURCE_DIR}/algorithms/broadphase/naive.cpp text)
string(REPLACE "\"naive\"" "\"bucket_sort\"" text "${text}")
string(REPLACE "Naive" "BucketSort" text "${text}")
set(mine ${tree}/algorithms/broadphase/bucket_sort.cpp)
file(WRITE ${mine} "${text}")

# Step 3: build and look.
must(${CMAKE_COMMAND} -G Ninja -S ${tree} -B ${WORK_DIR}/build -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS=-O0
     -DCMAKE_CXX_FLAGS_DEBUG= -DLPC_PRECISIONS=f64 -DLPC_BUILD_TESTS=ON -DLPC_BUILD_ORACLES=OFF
     -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER})
# determinism_f64: this build is the one at -O0 with assertions whose histories are compared with the pinned ones.
must(${CMAKE_COMMAND} --build ${WORK_DIR}/build --target lpc test_broadphase_f64 determinism_f64)
set(lpc ${WORK_DIR}/build/bin/lpc)
must(${lpc} list)
if(NOT output MATCHES "bucket_sort")
  message(FATAL_ERROR "lpc list does not show bucket_sort:\n${output}")
endif()

# Step 4: the conformance tests run it; a broken one is caught.
set(ENV{LPC_TEST_CASES} 3)  # long histories, without optimisation
set(conformance ${WORK_DIR}/build/bin/test_broadphase_f64)
must(${conformance} --gtest_filter=BroadphasePairs.*)
string(REPLACE "proxies.mayCollide" "a % 7 != 3 && proxies.mayCollide" broken "${text}")
if(broken STREQUAL text)
  message(FATAL_ERROR "naive.cpp has changed: this test no longer knows how to break it")
endif()
file(WRITE ${mine} "${broken}")
must(${CMAKE_COMMAND} --build ${WORK_DIR}/build --target test_broadphase_f64)
run(result output ${conformance} --gtest_filter=BroadphasePairs.*)
if(result EQUAL 0 OR NOT output MATCHES "bucket_sort")
  message(FATAL_ERROR "the conformance tests do not catch a broadphase that loses pairs:\n${output}")
endif()
file(WRITE ${mine} "${text}")
must(${CMAKE_COMMAND} --build ${WORK_DIR}/build --target lpc)

# Step 5: sweep.
file(WRITE ${WORK_DIR}/small.toml "summary = \"two broadphases\"\nkind = \"boxes\"\n[axes]\nbroadphase = \"*\"\ndimension = 2\nn = [16, 32]\nframes = 3\ndistribution = \"uniform\"\n")
must(${lpc} sweep ${WORK_DIR}/small.toml --only bucket_sort,naive --store ${WORK_DIR}/store.db --quiet)
if(NOT output MATCHES "4 run, 0 of these not ok")
  message(FATAL_ERROR "the sweep did not run bucket_sort and naive at two sizes each:\n${output}")
endif()
must(${lpc} sweep ${WORK_DIR}/small.toml --only bucket_sort,naive --store ${WORK_DIR}/store.db --quiet)
if(NOT output MATCHES "4 were done, 0 run")
  message(FATAL_ERROR "done trials are run again:\n${output}")
endif()
