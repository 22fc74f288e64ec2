lookout_test(NAME unit_recorder SOURCES unit/recorder/service_test.cpp LINKS lookout_recorder lookout_wire)
