lookout_test(NAME unit_replay SOURCES unit/replay/plan_test.cpp LINKS lookout_replay)
