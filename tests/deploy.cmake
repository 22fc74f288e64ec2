# lookout-up and its processes, killed one by one. In namespaces of their own, so that nothing of them is left.
add_executable(system_restart system/restart_test.cpp)
target_link_libraries(system_restart PRIVATE lookout_bus lookout_wire GTest::gtest GTest::gtest_main)
target_compile_definitions(system_restart PRIVATE LOOKOUT_SOURCE_DIR="${CMAKE_SOURCE_DIR}" LOOKOUT_BIN_DIR="${CMAKE_BINARY_DIR}/bin")
set_target_properties(system_restart PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
add_dependencies(system_restart lookout-vlp16 lookout-segmenter lookout-navigator lookout-georeferencer lookout-recorder lookout-sim)
add_test(NAME system_restart COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/system/in_namespace.sh route $<TARGET_FILE:system_restart>)
set_tests_properties(system_restart PROPERTIES TIMEOUT 180 SKIP_RETURN_CODE 77 RUN_SERIAL TRUE)
add_test(NAME system_deploy COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/system/deploy_test.sh ${CMAKE_SOURCE_DIR} ${CMAKE_BINARY_DIR})
set_tests_properties(system_deploy PROPERTIES TIMEOUT 60)
lookout_slow_test(NAME system_restart ENVIRONMENT LOOKOUT_KILL_ROUNDS=5
                  COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/system/in_namespace.sh route $<TARGET_FILE:system_restart>)
lookout_slow_test(NAME check_package COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/system/package_test.sh)
