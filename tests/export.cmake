lookout_test(NAME unit_export
             SOURCES unit/export/csv_test.cpp unit/export/scan_joiner_test.cpp unit/export/turn_picker_test.cpp unit/export/tables_test.cpp
                     unit/export/export_test.cpp
             LINKS lookout_export)
add_dependencies(unit_export lookout-export)
