# The plugin of lcm-spy, in Java as it is.
set(spy_test_classes ${CMAKE_BINARY_DIR}/tests/spy_classes)
add_custom_command(
  OUTPUT ${spy_test_classes}/lookout/spy/SpyTest.class
  COMMAND ${LOOKOUT_JAVA} ${JAVAC} -encoding UTF-8 -Xlint:all -Werror -cp ${LCM_JAR}:${CMAKE_BINARY_DIR}/lookout-types.jar:${CMAKE_BINARY_DIR}/lookout-spy.jar -d ${spy_test_classes}
          ${CMAKE_CURRENT_SOURCE_DIR}/unit/spy/SpyTest.java
  DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/unit/spy/SpyTest.java ${CMAKE_BINARY_DIR}/lookout-spy.jar
  COMMENT "Test of the plugin for lcm-spy"
  VERBATIM)
add_custom_target(unit_spy ALL DEPENDS ${spy_test_classes}/lookout/spy/SpyTest.class)
add_dependencies(unit_spy lookout-spy)
# The heap of lookout-spy: a corrupt count must fail there too. And once more as where the decimal point is a comma and the small I has no dot.
set(spy_test -Djava.awt.headless=true -Xmx256m -cp
             ${LCM_JAR}:${CMAKE_BINARY_DIR}/lookout-types.jar:${CMAKE_BINARY_DIR}/lookout-spy.jar:${spy_test_classes} lookout.spy.SpyTest)
add_test(NAME unit_spy COMMAND ${LOOKOUT_JAVA} ${JAVA} ${spy_test})
add_test(NAME unit_spy_turkish COMMAND ${LOOKOUT_JAVA} ${JAVA} -Duser.language=tr -Duser.country=TR -Dfile.encoding=US-ASCII ${spy_test})
add_test(NAME unit_spy_start COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/unit/spy/start_test.sh ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/lookout-spy)
set_tests_properties(unit_spy unit_spy_turkish unit_spy_start PROPERTIES TIMEOUT 120)
