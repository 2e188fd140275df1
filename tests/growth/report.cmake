# Runs a sweep of two resolvers on three boxes, prints the report's list of charts and the table of one chart, and compares the
# table with EXPECT. The sweep runs once; its data suffice for charts and metrics added later.
#   cmake -DTREE=... -DBIN=... -DWORK=... -DPYTHON=... -DTABLE=... -DEXPECT=... -P report.cmake
file(WRITE ${WORK}/report.toml [[
summary = "three boxes"
kind = "world"
timed = true
untimed = true
[axes]
scene = "vertical_stack"
dimension = 2
n = 3
gap = 0
steps = 60
[axes.resolver]
"catto" = "solver=split_solver{velocity=catto{iterations=4}}"
"soft_step" = "solver=soft_step{substeps=4}"
]])
set(make ${PYTHON} -B ${TREE}/reports/make.py --store ${WORK}/report.db)
foreach(command IN ITEMS "${BIN}/lpc;sweep;${WORK}/report.toml;--store;${WORK}/report.db;--quiet" "${make};--list"
        "${make};--out;${WORK}/report;--only;${TABLE}")
  execute_process(COMMAND ${command} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  message("${output}")
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${command}\nended with ${result}")
  endif()
endforeach()
file(READ ${WORK}/report/tables/${TABLE}.csv table)
message("${table}")
if(NOT table MATCHES "${EXPECT}")
  message(FATAL_ERROR "the table of ${TABLE} should match ${EXPECT}")
endif()
