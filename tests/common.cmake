lookout_test(NAME structure SOURCES structure/structure_test.cpp LINKS lookout_bus)
lookout_test(NAME unit_common
             SOURCES unit/common/angles_test.cpp unit/common/clock_fit_test.cpp unit/common/frames_test.cpp unit/common/bytes_test.cpp unit/common/bus_test.cpp
                     unit/common/sequence_test.cpp unit/common/log_file_test.cpp unit/common/wire_description_test.cpp
                     unit/common/text_config_test.cpp unit/common/health_test.cpp unit/common/notify_test.cpp unit/common/output_file_test.cpp
             LINKS lookout_runtime lookout_bus lookout_config lookout_io lookout_wire lcm)
lookout_fuzz(NAME fuzz_message SOURCES fuzz/message_fuzz.cpp LINKS lookout_bus lookout_wire)
lookout_fuzz(NAME fuzz_config SOURCES fuzz/config_fuzz.cpp LINKS lookout_config)
