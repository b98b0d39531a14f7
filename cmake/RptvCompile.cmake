# SPDX-License-Identifier: MIT
# One way to compile everything: C++20, warnings as errors, the include root, optional sanitizers.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(THREADS_PREFER_PTHREAD_FLAG ON)
find_package(Threads REQUIRED)

set(RPTV_SANITIZE "" CACHE STRING "Sanitizers, as for -fsanitize= (for instance address,undefined)")

find_program(CCACHE ccache)
if(CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
endif()

add_library(rptv_flags INTERFACE)
target_include_directories(rptv_flags INTERFACE ${PROJECT_SOURCE_DIR})
# -ffp-contract=off: the same arithmetic on every backend and optimisation level; fused steps are written as fma().
target_compile_options(rptv_flags INTERFACE "$<$<COMPILE_LANGUAGE:C,CXX>:-Wall;-Wextra;-Wconversion;-Werror;-ffp-contract=off>")
target_link_libraries(rptv_flags INTERFACE Threads::Threads)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # GCC 12 warns of overlapping copies inside std::string that cannot be (its bug 105651), at -O3.
  target_compile_options(rptv_flags INTERFACE $<$<COMPILE_LANGUAGE:C,CXX>:-Wno-restrict>)
endif()
if(NOT RPTV_SANITIZE)
  target_compile_options(rptv_flags INTERFACE $<$<COMPILE_LANGUAGE:C,CXX>:-Wshadow>)  # elsewhere sources are joined, and one's variables hide another's constants
endif()
if(RPTV_SANITIZE)
  target_compile_options(rptv_flags INTERFACE -fsanitize=${RPTV_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(rptv_flags INTERFACE -fsanitize=${RPTV_SANITIZE})
  # Under a sanitizer Eigen aligns memory by itself, but its functions inside Debian's static Ceres do not; the linker keeps
  # one of both, and what one had allocated the other freed. malloc aligns to 16 bytes in either case, all that Eigen needs here.
  target_compile_definitions(rptv_flags INTERFACE EIGEN_MALLOC_ALREADY_ALIGNED=1)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # Instrumented std::function and std::regex set off GCC 12's flow analysis (its bug 105562); -Wtsan is about fences
    # that ThreadSanitizer cannot see, of which there are none.
    target_compile_options(rptv_flags INTERFACE -Wno-maybe-uninitialized -Wno-tsan)
  endif()
endif()

# rptv_library(name SOURCES… LINK… [ALONE…]): one static library per folder. A sanitizer's build compiles its sources several
# at a time; ALONE names those that cannot stand beside others (the same names in each).
function(rptv_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK;LINK_PRIVATE;ALONE" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  if(RPTV_SANITIZE)
    set_target_properties(${name} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 6)
    set_source_files_properties(${ARG_ALONE} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  endif()
  target_link_libraries(${name} PUBLIC rptv_flags ${ARG_LINK} PRIVATE ${ARG_LINK_PRIVATE})
endfunction()
