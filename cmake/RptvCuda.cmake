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
