# What a page tells its reader to write and to type. A block fenced with a language and a path is that file; one fenced
# with sh is commands.

# The block between the fence whose first line is `opening` and its end, from `from` on; `end`: where to look for the next.
# Empty, with end = -1, when there is none.
function(page_block text from opening out_block out_end)
  string(SUBSTRING "${text}" ${from} -1 rest)
  string(FIND "${rest}" "\n```${opening}\n" at)
  set(${out_block} "" PARENT_SCOPE)
  set(${out_end} -1 PARENT_SCOPE)
  if(at EQUAL -1)
    return()
  endif()
  string(LENGTH "\n```${opening}\n" skipped)
  math(EXPR begin "${at} + ${skipped}")
  string(SUBSTRING "${rest}" ${begin} -1 rest)
  string(FIND "${rest}" "\n```\n" length)
  math(EXPR length "${length} + 1")  # with its last line's end
  string(SUBSTRING "${rest}" 0 ${length} block)
  math(EXPR end "${from} + ${begin} + ${length} - 1")  # a line's end begins the next fence
  set(${out_block} "${block}" PARENT_SCOPE)
  set(${out_end} ${end} PARENT_SCOPE)
endfunction()

# Writes the file that the page calls `path` to `target`.
function(page_file page path target)
  file(READ ${page} text)
  cmake_path(GET path EXTENSION LAST_ONLY kind)
  cmake_path(GET path FILENAME name)
  set(language ${kind})
  string(REPLACE "." "" language "${language}")
  if(name STREQUAL CMakeLists.txt)
    set(language cmake)
  endif()
  page_block("${text}" 0 "${language} ${path}" block end)
  if(end EQUAL -1)
    message(FATAL_ERROR "${page} has no block that begins with ```${language} ${path}")
  endif()
  file(WRITE ${target} "${block}")
endfunction()

# All commands under the heading, up to the next one of its level, as one script.
function(page_commands page heading out)
  file(READ ${page} text)
  string(FIND "${text}" "\n## ${heading}\n" from)
  if(from EQUAL -1)
    message(FATAL_ERROR "${page} has no heading '## ${heading}'")
  endif()
  math(EXPR from "${from} + 1")
  string(SUBSTRING "${text}" ${from} -1 section)
  string(FIND "${section}" "\n## " length)
  string(SUBSTRING "${section}" 0 ${length} section)
  string(APPEND section "\n")  # the heading's search took the last one
  set(script "")
  page_block("${section}" 0 sh block end)
  while(NOT end EQUAL -1)
    string(APPEND script "${block}")
    page_block("${section}" ${end} sh block end)
  endwhile()
  if(script STREQUAL "")
    message(FATAL_ERROR "${page} has no commands under '## ${heading}'")
  endif()
  set(${out} "${script}" PARENT_SCOPE)
endfunction()

# Runs a script of bash in a folder; stops at the first command that fails. `output`: what it said.
function(run_script script folder)
  file(WRITE ${folder}/commands.sh "${script}")
  execute_process(COMMAND bash -ex commands.sh WORKING_DIRECTORY ${folder} RESULT_VARIABLE result OUTPUT_VARIABLE said
                  ERROR_VARIABLE said)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "a command of a page ended with ${result}:\n${said}")
  endif()
  set(output "${said}" PARENT_SCOPE)
endfunction()
