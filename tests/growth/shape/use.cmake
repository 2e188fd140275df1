# No library supports the kind: witnesses are skipped with a message. The referee judges LPC's methods on it.
new_sweep(bicones "
summary = \"a kind that no witness knows\"
kind = \"pairs\"
[axes]
dimension = 3
kind_a = \"sphere\"
kind_b = \"bicone\"
n = 6
pair_query = [\"gjk_epa\", \"libccd_gjk\"]
")
must_say("2 run" ${sweep})
file(STRINGS ${work}/bicones.db text)
string(REGEX MATCHALL "unsupported[^{]*sphere against bicone" rows "${text}")
list(LENGTH rows count)
if(NOT count EQUAL 1)
  message(FATAL_ERROR "${count} of 2 trials, the witness's alone, should be unsupported:\n${text}")
endif()
