lookout_test(NAME structure SOURCES structure/structure_test.cpp LINKS lookout_bus)
# What is linked into a service, down to what Eigen calls.
set(reaches_messages lookout_core lookout_io lookout_bus lookout_config lookout_runtime lookout_replay lookout_recorder)
foreach(service vlp16 segmenter navigator georeferencer)
  foreach(part _core "" _io _sources)
    if(TARGET lookout_${service}${part})
      list(APPEND reaches_messages lookout_${service}${part})
    endif()
  endforeach()
endforeach()
list(TRANSFORM reaches_messages REPLACE ".+" "$<TARGET_FILE:\\0>" OUTPUT_VARIABLE reaches_messages_files)
# How they are compiled: no macro says whether the compiler may fuse.
set(without_same_bytes "")
foreach(library ${reaches_messages})
  get_target_property(options ${library} COMPILE_OPTIONS)
  get_target_property(folder ${library} SOURCE_DIR)
  get_property(definitions DIRECTORY ${folder} PROPERTY COMPILE_DEFINITIONS)
  if(NOT "-ffp-contract=off" IN_LIST options OR NOT "EIGEN_DONT_VECTORIZE" IN_LIST definitions)
    string(APPEND without_same_bytes "${library} ")
  endif()
endforeach()
target_compile_definitions(structure PRIVATE LOOKOUT_WITHOUT_SAME_BYTES="${without_same_bytes}")
add_test(NAME structure_libm COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/structure/libm_test.sh ${CMAKE_NM} ${reaches_messages_files})
lookout_test(NAME unit_common
             SOURCES unit/common/angles_test.cpp unit/common/clock_fit_test.cpp unit/common/clock_fit_disturbances_test.cpp unit/common/frames_test.cpp unit/common/bytes_test.cpp unit/common/bus_test.cpp
                     unit/common/datagram_filter_test.cpp unit/common/sequence_test.cpp unit/common/stream_guard_test.cpp unit/common/log_file_test.cpp unit/common/wire_description_test.cpp
                     unit/common/text_config_test.cpp unit/common/health_test.cpp unit/common/boat_words_test.cpp unit/common/machine_test.cpp unit/common/notify_test.cpp unit/common/output_file_test.cpp
                     unit/common/printable_test.cpp unit/common/progress_test.cpp
             LINKS lookout_runtime lookout_bus lookout_config lookout_io lookout_wire lcm)
# Their bounds of error against the C library's long double and against GeographicLib.
lookout_test(NAME unit_elementary SOURCES unit/common/elementary_test.cpp LINKS lookout_core)
lookout_test(NAME unit_geodesy SOURCES unit/common/geodesy_test.cpp LINKS lookout_core ${GeographicLib_LIBRARIES})
lookout_fuzz(NAME fuzz_message SOURCES fuzz/message_fuzz.cpp LINKS lookout_bus lookout_wire)
lookout_fuzz(NAME fuzz_config SOURCES fuzz/config_fuzz.cpp LINKS lookout_config)
