# SPDX-License-Identifier: MIT
# Kernels on the CPU, for tests: the executor in tests/cuda_host stands in for the CUDA runtime.

# rptv_cuda_host_library(name SOURCES x_cuda.cu… [LINK…]): the CUDA sources, paths from the root of the tree, compiled by the C++
# compiler as C++17, as nvcc compiles them; .cpp among them as C++20. Never link it into a binary that has the real runtime, too.
function(rptv_cuda_host_library name)
  if(NOT RPTV_TESTS)
    return()
  endif()
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  set(wrappers)
  foreach(source ${ARG_SOURCES})
    if(NOT EXISTS ${PROJECT_SOURCE_DIR}/${source})
      message(FATAL_ERROR "rptv_cuda_host_library(${name}): no file ${source}; give paths from the root of the tree")
    endif()
    if(source MATCHES "[.]cpp$")
      list(APPEND wrappers ${PROJECT_SOURCE_DIR}/${source})
      continue()
    endif()
    string(REPLACE "/" "_" wrapper ${source})
    set(wrapper ${CMAKE_CURRENT_BINARY_DIR}/${name}_${wrapper}.cpp)
    file(CONFIGURE OUTPUT ${wrapper} CONTENT "#include \"${source}\"\n")
    set_source_files_properties(${wrapper} PROPERTIES COMPILE_OPTIONS -std=c++17)
    list(APPEND wrappers ${wrapper})
  endforeach()
  add_library(${name} STATIC EXCLUDE_FROM_ALL ${wrappers})
  target_include_directories(${name} BEFORE PRIVATE ${PROJECT_SOURCE_DIR}/tests/cuda_host)
  target_link_libraries(${name} PUBLIC rptv_flags rptv_cuda_host ${ARG_LINK})
endfunction()

# rptv_ptx_test(name TEST test SOURCES x_cuda.cu…): runs a test of rptv_cuda_host_library() once more, with the PTX that nvcc makes of
# the sources in place of their C++; every kernel that it launches must be in them. Without nvcc the test is skipped.
function(rptv_ptx_test name)
  if(NOT RPTV_TESTS OR RPTV_SANITIZE)
    return()
  endif()
  cmake_parse_arguments(ARG "" "TEST;FILTER" "SOURCES" ${ARGN})
  if(NOT RPTV_HAVE_CUDA)
    add_test(NAME ${name} COMMAND sh -c "echo 'skipped: PTX is made by nvcc, which is not here'; exit 77")
    set_tests_properties(${name} PROPERTIES SKIP_RETURN_CODE 77)
    return()
  endif()
  set(files)
  foreach(source ${ARG_SOURCES})
    string(REPLACE "/" "_" file ${source})
    set(file ${CMAKE_CURRENT_BINARY_DIR}/${name}_${file}.ptx)
    file(CONFIGURE OUTPUT ${file}.cu CONTENT "#include \"${source}\"\n")
    add_custom_command(OUTPUT ${file}
      COMMAND ${CMAKE_CUDA_COMPILER} -ccbin ${CMAKE_CUDA_HOST_COMPILER} -std=c++17 --fmad=false --expt-relaxed-constexpr -arch=compute_75 -ptx -I${PROJECT_SOURCE_DIR} -MD -MF ${file}.d -MT ${file}
        ${file}.cu -o ${file}
      DEPENDS ${PROJECT_SOURCE_DIR}/${source} DEPFILE ${file}.d COMMENT "PTX of ${source}" VERBATIM)
    list(APPEND files ${file})
  endforeach()
  add_custom_target(${name}_ptx DEPENDS ${files})
  add_dependencies(${ARG_TEST} ${name}_ptx)
  list(JOIN files ":" files)
  add_test(NAME ${name} COMMAND ${ARG_TEST} --gtest_filter=${ARG_FILTER}*)
  set_tests_properties(${name} PROPERTIES ENVIRONMENT "RPTV_CUDA_PTX=${files}" SKIP_RETURN_CODE 77 TIMEOUT 300)
endfunction()
