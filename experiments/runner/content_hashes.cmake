# cmake -DSOURCE=DIR -DLIST=FILE -DOUT=FILE -P content_hashes.cmake: one {"path", "SHA-256", "library"} per line of the
# list, which is a path, and for adapters the library with its version.
file(STRINGS ${LIST} sources)
set(lines "")
foreach(source IN LISTS sources)
  string(REGEX MATCH "^([^ ]+) ?(.*)$" unused "${source}")
  set(path ${CMAKE_MATCH_1})
  set(library "${CMAKE_MATCH_2}")
  file(SHA256 ${SOURCE}/${path} hash)
  string(APPEND lines "{\"${path}\", \"${hash}\", \"${library}\"},\n")
endforeach()
file(WRITE ${OUT} "${lines}")
