lookout_test(NAME unit_log SOURCES unit/log/commands_test.cpp LINKS lookout_log)
lookout_test(NAME unit_diff SOURCES unit/diff/compare_test.cpp unit/diff/diff_test.cpp LINKS lookout_diff lookout_log)
lookout_fuzz(NAME fuzz_wire_description SOURCES fuzz/wire_description_fuzz.cpp LINKS lookout_diff lookout_log)
