lookout_test(NAME unit_wire SOURCES unit/wire/fingerprints_test.cpp unit/wire/decode_test.cpp unit/wire/arrays_test.cpp unit/wire/counting_new.cpp
             LINKS lookout_bus lookout_wire)
target_compile_definitions(unit_wire PRIVATE LOOKOUT_WIRE_DIR="${CMAKE_BINARY_DIR}/lcmtypes/lookout")
