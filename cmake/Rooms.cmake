# Compile options of the whole project, and one function per kind of target.
set(LOOKOUT_SANITIZE "" CACHE STRING "Sanitizers, comma separated: address,undefined or thread")
set(LOOKOUT_FUZZ "" CACHE STRING "Fuzz targets: empty, SOURCES (compiled as plain objects for lint) or ON (libFuzzer, needs Clang)")

find_program(CCACHE ccache)
if(CCACHE)
  # A second checkout of the same sources takes what the first has compiled, whatever the locale.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${CMAKE_SOURCE_DIR} CCACHE_NOHASHDIR=1 CCACHE_SLOPPINESS=locale ${CCACHE})
endif()

add_compile_options(-Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wold-style-cast -Woverloaded-virtual -Werror)
# Same bytes on every computer: no fused multiply-add, and no Eigen kernels, whose order of sums (SSE, NEON) and fused multiply-adds (NEON) depend on the
# vector unit. For the whole project, since it changes how Eigen's types are aligned. The compiler's own vectors change no result.
add_compile_options(-ffp-contract=off)
add_compile_definitions(EIGEN_DONT_VECTORIZE)
# Loops over the cells of a turn as vectors also where their length is not known before: GCC 12 does so from -O3 on, Clang at -O2. No other result.
add_compile_options($<$<AND:$<CXX_COMPILER_ID:GNU>,$<CONFIG:RelWithDebInfo>>:-fvect-cost-model=dynamic>)
if(LOOKOUT_SANITIZE)
  add_compile_options(-fsanitize=${LOOKOUT_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${LOOKOUT_SANITIZE})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # Under sanitizers GCC 12 takes members of the standard library's own regex for uninitialised.
    add_compile_options(-Wno-maybe-uninitialized)
  endif()
endif()
if(LOOKOUT_FUZZ STREQUAL "ON")
  add_compile_options(-fsanitize=fuzzer-no-link)
endif()

# A room: its sources in this folder, and the rooms and libraries that it may use.
#   lookout_room(NAME lookout_core SOURCES a.cpp LINKS x y [PRIVATE_LINKS z])
function(lookout_room)
  cmake_parse_arguments(room "" "NAME" "SOURCES;LINKS;PRIVATE_LINKS" ${ARGN})
  if(room_SOURCES)
    add_library(${room_NAME} STATIC ${room_SOURCES})
    target_include_directories(${room_NAME} PUBLIC ${CMAKE_SOURCE_DIR})
    target_link_libraries(${room_NAME} PUBLIC ${room_LINKS} PRIVATE ${room_PRIVATE_LINKS})
  else()
    add_library(${room_NAME} INTERFACE)
    target_include_directories(${room_NAME} INTERFACE ${CMAKE_SOURCE_DIR})
    target_link_libraries(${room_NAME} INTERFACE ${room_LINKS})
  endif()
endfunction()

# Everything that the package holds: ./dev package builds this and no test.
add_custom_target(programs)

# A program: build/<preset>/bin/<NAME>, installed with all others
function(lookout_program)
  cmake_parse_arguments(program "" "NAME" "SOURCES;LINKS" ${ARGN})
  add_executable(${program_NAME} ${program_SOURCES})
  target_link_libraries(${program_NAME} PRIVATE ${program_LINKS})
  if(LOOKOUT_SANITIZE)
    target_compile_options(${program_NAME} PRIVATE -O0)  # a main reads its command line: made better, that takes longer than all else
  endif()
  add_dependencies(programs ${program_NAME})
  install(TARGETS ${program_NAME} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endfunction()

# A test program out of one file or more, run by ctest.
#   lookout_test(NAME unit_core SOURCES a_test.cpp LINKS lookout_core [TIMEOUT 60])
function(lookout_test)
  cmake_parse_arguments(test "" "NAME;TIMEOUT" "SOURCES;LINKS" ${ARGN})
  add_executable(${test_NAME} ${test_SOURCES})
  target_link_libraries(${test_NAME} PRIVATE ${test_LINKS} GTest::gtest GTest::gtest_main)
  target_include_directories(${test_NAME} PRIVATE ${CMAKE_SOURCE_DIR})
  target_compile_definitions(${test_NAME} PRIVATE LOOKOUT_SOURCE_DIR="${CMAKE_SOURCE_DIR}" LOOKOUT_BIN_DIR="${CMAKE_BINARY_DIR}/bin")
  set_target_properties(${test_NAME} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  add_test(NAME ${test_NAME} COMMAND ${test_NAME})
  if(NOT test_TIMEOUT)
    set(test_TIMEOUT 60)
  endif()
  if(LOOKOUT_SANITIZE)
    math(EXPR test_TIMEOUT "5 * ${test_TIMEOUT}")  # sanitizers slow filters and simulations ten times and more
  endif()
  set_tests_properties(${test_NAME} PROPERTIES TIMEOUT ${test_TIMEOUT} WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
endfunction()

# A test made longer by its environment: too long for every change, ./dev test slow runs it as slow_<NAME>.
#   lookout_slow_test(NAME system_proof ENVIRONMENT LOOKOUT_PROOF_SECONDS=60 [COMMAND a b] [TIMEOUT 600])
function(lookout_slow_test)
  cmake_parse_arguments(test "" "NAME;TIMEOUT" "ENVIRONMENT;COMMAND" ${ARGN})
  if(LOOKOUT_SANITIZE)
    return()
  endif()
  if(NOT test_COMMAND)
    set(test_COMMAND $<TARGET_FILE:${test_NAME}>)
  endif()
  if(NOT test_TIMEOUT)
    set(test_TIMEOUT 1800)
  endif()
  add_test(NAME slow_${test_NAME} COMMAND ${test_COMMAND})
  set_tests_properties(slow_${test_NAME} PROPERTIES LABELS slow ENVIRONMENT "${test_ENVIRONMENT}" TIMEOUT ${test_TIMEOUT} SKIP_RETURN_CODE 77 RUN_SERIAL TRUE
                                                    WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
endfunction()

# Speed under sanitizers tells nothing: benchmarks are not built there.
function(lookout_bench_options name)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bench)
  if(LOOKOUT_SANITIZE)
    set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL ON)
  endif()
endfunction()

# A Google Benchmark program, run by ./dev bench.
function(lookout_bench)
  cmake_parse_arguments(bench "" "NAME" "SOURCES;LINKS" ${ARGN})
  add_executable(${bench_NAME} ${bench_SOURCES})
  target_link_libraries(${bench_NAME} PRIVATE ${bench_LINKS} benchmark::benchmark benchmark::benchmark_main)
  target_compile_definitions(${bench_NAME} PRIVATE LOOKOUT_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
  lookout_bench_options(${bench_NAME})
endfunction()

# A libFuzzer target, run by ./dev fuzz. Its body is also compiled for lint where fuzzing itself is off.
#   lookout_fuzz(NAME fuzz_packet SOURCES fuzz/packet_fuzz.cpp LINKS lookout_vlp16_core)
add_custom_target(fuzzers)
function(lookout_fuzz)
  cmake_parse_arguments(fuzz "" "NAME" "SOURCES;LINKS" ${ARGN})
  if(LOOKOUT_FUZZ STREQUAL "ON")
    add_executable(${fuzz_NAME} ${fuzz_SOURCES})
    target_link_options(${fuzz_NAME} PRIVATE -fsanitize=fuzzer)
    set_target_properties(${fuzz_NAME} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/fuzz)
    add_dependencies(fuzzers ${fuzz_NAME})
  elseif(LOOKOUT_FUZZ STREQUAL "SOURCES")
    add_library(${fuzz_NAME} OBJECT ${fuzz_SOURCES})
  else()
    return()
  endif()
  target_link_libraries(${fuzz_NAME} PRIVATE ${fuzz_LINKS})
  target_include_directories(${fuzz_NAME} PRIVATE ${CMAKE_SOURCE_DIR})
endfunction()
