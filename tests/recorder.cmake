lookout_test(NAME unit_recorder SOURCES unit/recorder/service_test.cpp unit/recorder/rotation_test.cpp LINKS lookout_recorder lookout_wire)
