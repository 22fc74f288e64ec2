lookout_test(NAME unit_top SOURCES unit/top/board_test.cpp unit/top/screen_test.cpp LINKS lookout_top lookout_wire)
