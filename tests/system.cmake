# Programs as a user or a boat runs them. The live ones run in network namespaces that they make themselves.
lookout_test(NAME system_replay SOURCES system/replay_test.cpp LINKS lookout_bus lookout_wire TIMEOUT 300)
add_dependencies(system_replay lookout-replay lookout-export lookout-sim)

foreach(name live ingestion sources no_route)
  add_executable(system_${name} system/${name}_test.cpp)
  target_link_libraries(system_${name} PRIVATE lookout_bus lookout_wire GTest::gtest GTest::gtest_main)
  target_compile_definitions(system_${name} PRIVATE LOOKOUT_SOURCE_DIR="${CMAKE_SOURCE_DIR}" LOOKOUT_BIN_DIR="${CMAKE_BINARY_DIR}/bin")
  set_target_properties(system_${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
endforeach()
add_dependencies(system_live lookout-vlp16 lookout-segmenter lookout-navigator lookout-georeferencer lookout-recorder lookout-sim lookout-replay)
add_dependencies(system_ingestion lookout-vlp16 lookout-sim)
target_sources(system_sources PRIVATE system/hangup_test.cpp)
add_dependencies(system_sources lookout-vlp16)
add_dependencies(system_no_route lookout-segmenter)
add_test(NAME system_live COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/system/in_namespace.sh route $<TARGET_FILE:system_live>)
add_test(NAME system_ingestion COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/system/in_namespace.sh route $<TARGET_FILE:system_ingestion>)
add_test(NAME system_sources COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/system/in_namespace.sh route $<TARGET_FILE:system_sources>)
add_test(NAME system_no_route COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/system/in_namespace.sh no-route $<TARGET_FILE:system_no_route>)
# RUN_SERIAL: they keep real time.
set_tests_properties(system_live system_ingestion system_sources system_no_route PROPERTIES TIMEOUT 180 SKIP_RETURN_CODE 77 RUN_SERIAL TRUE)

# The load of ./dev bench, in a namespace as well. Not a Google Benchmark.
add_executable(load_vlp16 bench/vlp16_load.cpp)
target_link_libraries(load_vlp16 PRIVATE lookout_bus lookout_wire)
target_compile_definitions(load_vlp16 PRIVATE LOOKOUT_SOURCE_DIR="${CMAKE_SOURCE_DIR}" LOOKOUT_BIN_DIR="${CMAKE_BINARY_DIR}/bin")
set_target_properties(load_vlp16 PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bench)
add_dependencies(load_vlp16 lookout-vlp16)
