# cmake -DSOURCE=DIR -DLIST=FILE -DOUT=FILE -P content_hashes.cmake: one {"path", "SHA-256"} per listed source.
file(STRINGS ${LIST} paths)
set(lines "")
foreach(path IN LISTS paths)
  file(SHA256 ${SOURCE}/${path} hash)
  string(APPEND lines "{\"${path}\", \"${hash}\"},\n")
endforeach()
file(WRITE ${OUT} "${lines}")
