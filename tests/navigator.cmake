lookout_test(NAME unit_navigator
             SOURCES unit/navigator/arrivals_test.cpp unit/navigator/sentence_test.cpp unit/navigator/nmea_test.cpp unit/navigator/measurement_test.cpp
                     unit/navigator/item_sequencer_test.cpp unit/navigator/filter_test.cpp unit/navigator/filter_attitude_test.cpp
                     unit/navigator/filter_consistency_test.cpp unit/navigator/filter_recovery_test.cpp unit/navigator/filter_voyage_test.cpp unit/navigator/inputs_test.cpp unit/navigator/interpreter_test.cpp
                     unit/navigator/navigator_test.cpp unit/navigator/utc_clock_test.cpp unit/navigator/service_test.cpp
                     unit/navigator/recordings_test.cpp
             LINKS lookout_navigator lookout_config ${GeographicLib_LIBRARIES})
lookout_test(NAME property_navigator_clock SOURCES property/navigator_clock_disturbances_test.cpp property/navigator_turning_stalls_test.cpp LINKS lookout_navigator lookout_config TIMEOUT 180)
lookout_test(NAME unit_navigator_io SOURCES unit/navigator/io_test.cpp unit/navigator/text_log_test.cpp
             LINKS lookout_navigator_io lookout_navigator_text_log util)
lookout_test(NAME property_navigator SOURCES property/navigator_round_trip_test.cpp property/navigator_replay_test.cpp property/navigator_hostile_test.cpp
             LINKS lookout_navigator lookout_config)
lookout_fuzz(NAME fuzz_nmea_sentence SOURCES fuzz/nmea_sentence_fuzz.cpp LINKS lookout_navigator_core)
