lookout_test(NAME unit_doctor SOURCES unit/doctor/findings_test.cpp unit/doctor/report_test.cpp LINKS lookout_doctor)
