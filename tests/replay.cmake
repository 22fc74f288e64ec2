lookout_test(NAME unit_replay SOURCES unit/replay/one_publisher_test.cpp unit/replay/plan_test.cpp unit/replay/live_text_log_test.cpp LINKS lookout_replay lookout_navigator_text_log lookout_wire)
