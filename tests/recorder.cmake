lookout_test(NAME unit_recorder SOURCES unit/recorder/service_test.cpp unit/recorder/rotation_test.cpp LINKS lookout_recorder lookout_wire)

# The process itself, live in a namespace of its own.
add_executable(system_recorder system/recorder_test.cpp)
target_link_libraries(system_recorder PRIVATE lookout_bus lookout_wire GTest::gtest GTest::gtest_main)
target_compile_definitions(system_recorder PRIVATE LOOKOUT_SOURCE_DIR="${CMAKE_SOURCE_DIR}" LOOKOUT_BIN_DIR="${CMAKE_BINARY_DIR}/bin")
set_target_properties(system_recorder PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
add_dependencies(system_recorder lookout-recorder lookout-sim lookout-replay lookout-log lookout-diff)
add_test(NAME system_recorder COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/system/in_namespace.sh route $<TARGET_FILE:system_recorder>)
set_tests_properties(system_recorder PROPERTIES TIMEOUT 180 SKIP_RETURN_CODE 77 RUN_SERIAL TRUE)
