# A chart: one file. It states what data it needs and is drawn for every sweep that has them. No trial runs again.
set(at_most 1)
set(name report_tallest)
set(targets "")
set(needs_python ON)
set(proof ${CMAKE_COMMAND} -DTREE=${tree} -DBIN=${bin} -DWORK=${work} -DPYTHON=${PYTHON} -DTABLE=report_tallest
          "-DEXPECT=catto,2\\.5.*soft_step,2\\.5" -P ${here}/report.cmake)
set(listed ${proof})
set(blames "tallest.py: no series 'hieght'; valid: .*height")
