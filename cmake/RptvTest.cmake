# SPDX-License-Identifier: MIT
# How tests, benchmarks and fuzz targets are declared.

# What `scripts/test` builds of the TSan and fuzz presets.
add_custom_target(concurrent_tests)
add_custom_target(fuzz_targets)

# rptv_test(name SOURCES… LINK… [LABELS…] [ENVIRONMENT…] [TIMEOUT seconds] [RUNNER command…] [ARGUMENTS…]): one GoogleTest binary = one ctest entry.
# Label `concurrent` makes the TSan run build and execute it; tests over shared data use RPTV_SHARED_DATA from the environment and skip
# without it. RUNNER is what the binary is given to instead of being run here.
function(rptv_test name)
  if(NOT RPTV_TESTS)
    return()
  endif()
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;LINK;LABELS;ENVIRONMENT;RUNNER;ARGUMENTS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  find_package(GTest REQUIRED)
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE rptv_flags ${ARG_LINK} GTest::gtest GTest::gmock GTest::gtest_main)
  target_compile_definitions(${name} PRIVATE RPTV_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  if(concurrent IN_LIST ARG_LABELS)
    add_dependencies(concurrent_tests ${name})
  endif()
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)  # compiles in two thirds of the time; what it tests is at -O3
  if(RPTV_SANITIZE)
    target_compile_options(${name} PRIVATE -O0)  # instrumented tests compile in half the time; what they test is at -O1
    if("system" IN_LIST ARG_LABELS OR "experiment" IN_LIST ARG_LABELS)
      set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL ON)  # scripts/test leaves them out there; built by name
    endif()
  endif()
  add_test(NAME ${name} COMMAND ${ARG_RUNNER} $<TARGET_FILE:${name}> ${ARG_ARGUMENTS})
  set_tests_properties(${name} PROPERTIES LABELS "${ARG_LABELS}" SKIP_RETURN_CODE 77 TIMEOUT ${ARG_TIMEOUT} ENVIRONMENT "${ARG_ENVIRONMENT}")
endfunction()

# rptv_bench(name SOURCES… LINK…): one Google Benchmark binary, never run by ctest.
function(rptv_bench name)
  if(NOT RPTV_BENCH)
    return()
  endif()
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  find_package(benchmark REQUIRED)
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE rptv_flags ${ARG_LINK} benchmark::benchmark)
endfunction()

# rptv_fuzz(name SOURCES… LINK…): one libFuzzer target; seeds in tests/fuzz/corpus/<name>.
function(rptv_fuzz name)
  if(NOT RPTV_FUZZ)
    return()
  endif()
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE rptv_flags ${ARG_LINK})
  target_link_options(${name} PRIVATE -fsanitize=fuzzer)
  add_dependencies(fuzz_targets ${name})
  add_test(NAME ${name} COMMAND ${PROJECT_SOURCE_DIR}/scripts/fuzz_one $<TARGET_FILE:${name}> ${PROJECT_SOURCE_DIR}/tests/fuzz/corpus/${name})
  set_tests_properties(${name} PROPERTIES LABELS fuzz TIMEOUT 600)
endfunction()
