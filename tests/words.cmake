# Pages against programs.
add_test(NAME system_options COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/system/options_test.sh ${CMAKE_SOURCE_DIR} ${CMAKE_BINARY_DIR})
add_test(NAME system_python COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/system/python_test.sh ${CMAKE_SOURCE_DIR} ${CMAKE_BINARY_DIR})
set_tests_properties(system_options system_python PROPERTIES TIMEOUT 60 SKIP_RETURN_CODE 77)
