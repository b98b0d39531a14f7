# SPDX-License-Identifier: MIT
# Finds nvcc, or does without, and says how CUDA sources are compiled by it.

set(RPTV_CUDA AUTO CACHE STRING "CUDA backend: AUTO (where nvcc works), ON or OFF")
set_property(CACHE RPTV_CUDA PROPERTY STRINGS AUTO ON OFF)
set(RPTV_CUDA_ARCHS "" CACHE STRING "GPU architectures, as for CMAKE_CUDA_ARCHITECTURES; empty: all that nvcc knows of 75 80 86 89 90 120")
string(TOUPPER "${RPTV_CUDA}" RPTV_CUDA_WANTED)
if(NOT RPTV_CUDA_WANTED MATCHES "^(AUTO|ON|OFF|TRUE|FALSE|YES|NO|1|0)$")
  message(FATAL_ERROR "RPTV_CUDA=${RPTV_CUDA} is neither AUTO, ON nor OFF; choose one")
endif()
set(RPTV_HAVE_CUDA OFF)

# nvcc, unless CUDACXX or CMAKE_CUDA_COMPILER names one already.
function(rptv_find_nvcc)
  if(DEFINED ENV{CUDACXX} OR CMAKE_CUDA_COMPILER)
    return()
  endif()
  find_program(RPTV_NVCC nvcc PATHS /usr/local/cuda/bin /opt/cuda/bin DOC "CUDA compiler")
  if(RPTV_NVCC)
    set(CMAKE_CUDA_COMPILER "${RPTV_NVCC}" CACHE FILEPATH "CUDA compiler")
  endif()
endfunction()

# Machine code for each architecture that this nvcc knows, and PTX of the newest for GPUs to come. Never `native`: without a
# GPU nvcc then takes a default of its own.
function(rptv_choose_cuda_archs)
  if(RPTV_CUDA_ARCHS)
    set(CMAKE_CUDA_ARCHITECTURES "${RPTV_CUDA_ARCHS}" PARENT_SCOPE)
    return()
  endif()
  set(known "")
  if(CMAKE_CUDA_COMPILER)
    execute_process(COMMAND "${CMAKE_CUDA_COMPILER}" --list-gpu-arch OUTPUT_VARIABLE listed ERROR_QUIET)
    foreach(arch 75 80 86 89 90 120)
      if(listed MATCHES "compute_${arch}([^0-9]|$)")
        list(APPEND known ${arch}-real)
        set(newest ${arch}-virtual)
      endif()
    endforeach()
  endif()
  if(known)
    set(CMAKE_CUDA_ARCHITECTURES ${known} ${newest} PARENT_SCOPE)
  else()
    set(CMAKE_CUDA_ARCHITECTURES OFF PARENT_SCOPE)
  endif()
endfunction()

if(RPTV_CUDA_WANTED STREQUAL "AUTO" AND RPTV_SANITIZE)
  set(RPTV_CUDA_WANTED OFF)  # device code has no sanitizer; the tests run it on the CPU there
endif()
if(RPTV_CUDA_WANTED STREQUAL "AUTO" OR RPTV_CUDA_WANTED)
  rptv_find_nvcc()
  if(NOT CMAKE_CUDA_HOST_COMPILER AND NOT DEFINED ENV{CUDAHOSTCXX})
    set(CMAKE_CUDA_HOST_COMPILER "${CMAKE_CXX_COMPILER}" CACHE FILEPATH "nvcc -ccbin")
  endif()
  rptv_choose_cuda_archs()  # before the language is enabled
  include(CheckLanguage)
  check_language(CUDA)  # no error where nvcc is broken or does not take the host compiler
  if(CMAKE_CUDA_COMPILER)
    enable_language(CUDA)
    find_package(CUDAToolkit REQUIRED)
    set(RPTV_HAVE_CUDA ON)
    if(CCACHE)
      set(CMAKE_CUDA_COMPILER_LAUNCHER ${CCACHE})
    endif()
    message(STATUS "CUDA ${CMAKE_CUDA_COMPILER_VERSION} for ${CMAKE_CUDA_ARCHITECTURES}")
  elseif(RPTV_CUDA_WANTED STREQUAL "AUTO")
    message(STATUS "No CUDA backend: nvcc is missing or does not work with ${CMAKE_CXX_COMPILER} (RPTV_CUDA=ON says so as an error)")
  else()
    message(FATAL_ERROR "RPTV_CUDA=ON, but nvcc is missing or does not work with ${CMAKE_CXX_COMPILER}: install the CUDA toolkit (11.8 or newer), "
                        "name nvcc in CUDACXX and a host compiler that it takes in CUDAHOSTCXX, or configure with RPTV_CUDA=OFF")
  endif()
endif()

# rptv_cuda_library(name SOURCES x_cuda.cu… LINK…): a static library of CUDA (and C++) sources, which share no device functions.
# C++17: nvcc 11.8 has no newer one, and CMake 3.25.1 knows none of nvcc's. Rounding is as on the CPU: nothing is fused.
function(rptv_cuda_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  set_target_properties(${name} PROPERTIES CUDA_STANDARD 17 CUDA_STANDARD_REQUIRED ON CUDA_EXTENSIONS OFF
    CUDA_SEPARABLE_COMPILATION OFF CUDA_RUNTIME_LIBRARY Static POSITION_INDEPENDENT_CODE ON)
  target_compile_options(${name} PRIVATE "$<$<COMPILE_LANGUAGE:CUDA>:--fmad=false;--expt-relaxed-constexpr;--threads=2;\
-Werror=all-warnings;-Xcompiler=-ffp-contract=off,-Wall,-Wextra,-Werror>")
  target_link_libraries(${name} PUBLIC rptv_flags ${ARG_LINK} PRIVATE CUDA::cudart_static)
endfunction()
