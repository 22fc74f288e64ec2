# Programs as a user or a boat runs them. The live ones run in network namespaces that they make themselves.
lookout_test(NAME system_replay SOURCES system/replay_test.cpp LINKS lookout_bus lookout_wire TIMEOUT 300)
add_dependencies(system_replay lookout-replay lookout-export lookout-sim)
lookout_test(NAME system_hostile_text SOURCES system/hostile_text_test.cpp LINKS lookout_bus lookout_wire)
add_dependencies(system_hostile_text lookout-replay lookout-export lookout-log lookout-diff lookout-eval lookout-doctor lookout-sim lookout-vlp16 lookout-segmenter
                 lookout-navigator lookout-georeferencer lookout-recorder)
lookout_test(NAME system_same_bytes SOURCES system/same_bytes_test.cpp TIMEOUT 300)
add_dependencies(system_same_bytes lookout-replay lookout-sim)
lookout_test(NAME system_points SOURCES system/points_test.cpp TIMEOUT 120)
add_dependencies(system_points lookout-eval)
lookout_test(NAME system_mounting_error SOURCES system/mounting_error_test.cpp LINKS lookout_bus lookout_wire TIMEOUT 120)
add_dependencies(system_mounting_error lookout-replay lookout-eval lookout-sim)

# The same bytes whatever the locale, and lookout-up from a folder whose name no shell likes.
add_custom_target(system_locale)
add_dependencies(system_locale programs)
add_test(NAME system_locale COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/system/in_namespace.sh route
                                    ${CMAKE_CURRENT_SOURCE_DIR}/system/locale_test.sh ${CMAKE_SOURCE_DIR} ${CMAKE_BINARY_DIR})
set_tests_properties(system_locale PROPERTIES TIMEOUT 180 SKIP_RETURN_CODE 77)

foreach(name live proof ingestion sources no_route two_computers two_publishers doctor alarm bus_guard)
  add_executable(system_${name} system/${name}_test.cpp)
  target_link_libraries(system_${name} PRIVATE lookout_bus lookout_wire GTest::gtest GTest::gtest_main)
  target_compile_definitions(system_${name} PRIVATE LOOKOUT_SOURCE_DIR="${CMAKE_SOURCE_DIR}" LOOKOUT_BIN_DIR="${CMAKE_BINARY_DIR}/bin")
  set_target_properties(system_${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
endforeach()
add_dependencies(system_live lookout-vlp16 lookout-segmenter lookout-navigator lookout-georeferencer lookout-recorder lookout-sim lookout-replay)
add_dependencies(system_proof lookout-vlp16 lookout-segmenter lookout-navigator lookout-georeferencer lookout-recorder lookout-sim lookout-replay)
add_dependencies(system_ingestion lookout-vlp16 lookout-sim)
target_sources(system_live PRIVATE system/text_log_test.cpp)
target_sources(system_sources PRIVATE system/hangup_test.cpp)
add_dependencies(system_sources lookout-vlp16)
add_dependencies(system_no_route lookout-segmenter)
add_dependencies(system_alarm lookout-georeferencer)
add_dependencies(system_two_computers lookout-vlp16 lookout-segmenter lookout-navigator lookout-georeferencer lookout-recorder lookout-sim)
add_dependencies(system_two_publishers lookout-vlp16 lookout-segmenter lookout-navigator lookout-georeferencer lookout-recorder lookout-sim
                 lookout-log lookout-replay lookout-diff)
add_test(NAME system_two_publishers COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/system/in_namespace.sh route $<TARGET_FILE:system_two_publishers>)
add_test(NAME system_live COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/system/in_namespace.sh route $<TARGET_FILE:system_live>)
add_test(NAME system_proof COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/system/in_namespace.sh route $<TARGET_FILE:system_proof>)
add_test(NAME system_ingestion COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/system/in_namespace.sh route $<TARGET_FILE:system_ingestion>)
add_test(NAME system_sources COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/system/in_namespace.sh route $<TARGET_FILE:system_sources>)
target_link_libraries(system_alarm PRIVATE lookout_georeferencer)
add_test(NAME system_alarm COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/system/in_namespace.sh route $<TARGET_FILE:system_alarm>)
add_test(NAME system_no_route COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/system/in_namespace.sh no-route $<TARGET_FILE:system_no_route>)
add_test(NAME system_two_computers COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/system/in_namespace.sh no-route $<TARGET_FILE:system_two_computers>)
add_dependencies(system_doctor lookout-doctor lookout-vlp16 lookout-segmenter lookout-navigator lookout-georeferencer lookout-recorder lookout-sim)
add_test(NAME system_doctor
         COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/system/in_namespace.sh route $<TARGET_FILE:system_doctor> --gtest_filter=-*WhereNothingIs)
add_test(NAME system_doctor_no_route
         COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/system/in_namespace.sh no-route $<TARGET_FILE:system_doctor> --gtest_filter=*WhereNothingIs)
# Datagrams that LCM's receiver dies of, against every process; ./dev test slow sends a million of them.
add_dependencies(system_bus_guard lookout-vlp16 lookout-segmenter lookout-navigator lookout-georeferencer lookout-recorder lookout-top lookout-doctor)
add_test(NAME system_bus_guard COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/system/in_namespace.sh route $<TARGET_FILE:system_bus_guard>)
lookout_slow_test(NAME system_bus_guard ENVIRONMENT LOOKOUT_BUS_DATAGRAMS=1000000
                  COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/system/in_namespace.sh route $<TARGET_FILE:system_bus_guard>)
# RUN_SERIAL: they keep real time.
set_tests_properties(system_live system_proof system_ingestion system_sources system_no_route system_two_computers system_two_publishers system_doctor system_doctor_no_route
                     system_alarm system_bus_guard
                     PROPERTIES TIMEOUT 180 SKIP_RETURN_CODE 77 RUN_SERIAL TRUE)
lookout_slow_test(NAME system_proof ENVIRONMENT LOOKOUT_PROOF_SECONDS=60
                  COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/system/in_namespace.sh route $<TARGET_FILE:system_proof>)

# The loads of ./dev bench, in a namespace as well. Not Google Benchmarks.
foreach(name vlp16 live disturbed)
  add_executable(load_${name} bench/${name}_load.cpp)
  target_link_libraries(load_${name} PRIVATE lookout_bus lookout_wire)
  target_compile_definitions(load_${name} PRIVATE LOOKOUT_SOURCE_DIR="${CMAKE_SOURCE_DIR}" LOOKOUT_BIN_DIR="${CMAKE_BINARY_DIR}/bin")
  lookout_bench_options(load_${name})
  add_dependencies(load_${name} lookout-vlp16)
endforeach()
target_link_libraries(load_live PRIVATE lcm)
target_link_libraries(load_disturbed PRIVATE lookout_sim)
foreach(name live disturbed)
  add_dependencies(load_${name} lookout-segmenter lookout-navigator lookout-georeferencer lookout-recorder lookout-sim)
endforeach()

# Each program that writes a file, against files, links, folders, signals and full disks.
add_test(NAME system_outputs COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/system/outputs_test.sh ${CMAKE_SOURCE_DIR} ${CMAKE_BINARY_DIR}/bin)
set(outputs_timeout 180)
if(LOOKOUT_SANITIZE)
  set(outputs_timeout 900)
endif()
set_tests_properties(system_outputs PROPERTIES TIMEOUT ${outputs_timeout})

# Ctrl-C ends the demo and all that it runs.
add_test(NAME system_demo_stop COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/system/in_namespace.sh route ${CMAKE_CURRENT_SOURCE_DIR}/system/demo_stop_test.sh
                                       ${CMAKE_SOURCE_DIR} ${CMAKE_BINARY_DIR}/bin)
set_tests_properties(system_demo_stop PROPERTIES TIMEOUT 120 SKIP_RETURN_CODE 77 RUN_SERIAL TRUE)

# The order in which the demo and lookout-up start and end the processes.
foreach(by demo lookout-up)
  add_test(NAME system_order_${by} COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/system/in_namespace.sh route
           ${CMAKE_CURRENT_SOURCE_DIR}/system/live_processes_test.sh ${CMAKE_SOURCE_DIR} ${CMAKE_BINARY_DIR}/bin ${by})
  set_tests_properties(system_order_${by} PROPERTIES TIMEOUT 120 SKIP_RETURN_CODE 77 RUN_SERIAL TRUE)
endforeach()
