# Reads lcmtypes/*.lcm, from which code is made that the generated C++ types do not have.

#   lookout_lcm_files(FILES)  sets FILES to those of all types; CMake runs again where one changes
function(lookout_lcm_files files_variable)
  file(GLOB files CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/lcmtypes/*.lcm)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${files})
  set(${files_variable} ${files} PARENT_SCOPE)
endfunction()

#   lookout_lcm_fields(FILE FIELDS SIZES)  sets FIELDS to "type name[dimensions]$" of each member in its order, SIZES to the names that are sizes of arrays
function(lookout_lcm_fields file fields_variable sizes_variable)
  file(READ ${file} text)
  string(REGEX REPLACE "//[^\n]*" "" text "${text}")
  string(REPLACE ";" "$" text "${text}")  # no list of CMake's
  string(REGEX REPLACE "^.*{" "" text "${text}")
  string(REGEX REPLACE "const [^$]*\\$" "" text "${text}")
  string(REGEX MATCHALL "[a-z0-9_.]+ +[a-z0-9_]+[^$]*\\$" fields "${text}")
  set(sizes "")
  foreach(field ${fields})
    string(REGEX REPLACE "^[a-z0-9_.]+ +([a-z0-9_]+).*$" "\\1" name "${field}")
    if(text MATCHES "\\[${name}\\]")
      list(APPEND sizes ${name})
    endif()
  endforeach()
  set(${fields_variable} ${fields} PARENT_SCOPE)
  set(${sizes_variable} ${sizes} PARENT_SCOPE)
endfunction()
