# A metric computed from stored trials: one entry. Nothing is compiled, and no trial runs again.
set(at_most 1)
set(name highest)
set(targets "")
set(needs_python ON)
set(proof ${CMAKE_COMMAND} -DTREE=${tree} -DBIN=${bin} -DWORK=${work} -DPYTHON=${PYTHON} -DTABLE=report_vertical_stack__2d
          "-DEXPECT=highest body \\[m\\].*,2\\.49" -P ${here}/report.cmake)
set(listed ${proof})
set(blames "no series 'hieght'; valid: .*height")
