lookout_test(NAME unit_replay SOURCES unit/replay/plan_test.cpp unit/replay/live_text_log_test.cpp LINKS lookout_replay lookout_navigator_text_log)
