lookout_test(NAME unit_replay SOURCES unit/replay/one_publisher_test.cpp unit/replay/plan_test.cpp unit/replay/text_log_test.cpp LINKS lookout_replay lookout_wire)
