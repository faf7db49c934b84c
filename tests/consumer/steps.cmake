# What the scripts of this folder share. `sources` is the root of the sources.

# Runs a command; all ends if it fails.
macro(must)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endmacro()

# The code block of README that follows the comment <!-- NAME -->.
function(code_block readme name result)
  file(READ ${sources}/${readme} text)
  set(opening "<!-- ${name} -->\n```")
  string(FIND "${text}" "${opening}" start)
  if(start LESS 0)
    message(FATAL_ERROR "${readme} has no block ${name}")
  endif()
  string(SUBSTRING "${text}" ${start} -1 text)
  string(REGEX REPLACE "^<!--[^\n]*\n```[^\n]*\n" "" text "${text}")
  string(FIND "${text}" "\n```" end)
  string(SUBSTRING "${text}" 0 ${end} text)
  set(${result} "${text}\n" PARENT_SCOPE)
endfunction()

# `text` holds what `pattern` matches, or all ends.
function(expect text pattern)
  if(NOT text MATCHES "${pattern}")
    message(FATAL_ERROR "expected, but not found: ${pattern}\n${text}")
  endif()
endfunction()
