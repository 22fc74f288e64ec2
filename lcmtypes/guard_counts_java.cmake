# As guard_counts.cmake, for lcm-gen's Java: an array is made only when the bytes that are left can fill it. A corrupt count made lcm-spy ask for
# gigabytes, and run out of memory where another thread needed some.
file(GLOB types ${FOLDER}/*_t.java)
foreach(type ${types})
  file(READ ${type} text)
  string(REGEX REPLACE
    "this\\.([a-z0-9_]+) = new ([A-Za-z0-9_.]+)\\[\\(int\\) (num_[a-z0-9_]+)\\];"
    "this.\\1 = new \\2[Counts.checked(\\3, ins)];"
    text "${text}")
  string(REPLACE "new char[ins.readInt()-1]" "new char[Counts.checked(ins.readInt()-1, ins)]" text "${text}")
  # Another lcm-gen may write it in other words: not unnoticed.
  if(text MATCHES "this\\.[a-z0-9_]+ = new [A-Za-z0-9_.]+\\[\\(int\\) [a-z]" OR text MATCHES "\\[ins\\.readInt")
    message(FATAL_ERROR "${type}: a count is not guarded: ${CMAKE_MATCH_0}")
  endif()
  file(WRITE ${type} "${text}")
endforeach()
