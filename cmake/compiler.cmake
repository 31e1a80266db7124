# SPDX-License-Identifier: GPL-3.0-or-later
# One place for what every target is compiled with.
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
# Nothing of the library is replaced at run time, so that calls within it need no table and may be inlined.
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)
if(PROJECT_IS_TOP_LEVEL AND NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()

# What was compiled before, in whichever build folder, comes from build/ccache. Another launcher, or an empty one, is kept.
find_program(DAPPLE_CCACHE ccache)
mark_as_advanced(DAPPLE_CCACHE)
if(PROJECT_IS_TOP_LEVEL AND DAPPLE_CCACHE AND NOT DEFINED CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER
      ${CMAKE_COMMAND} -E env CCACHE_DIR=${PROJECT_SOURCE_DIR}/build/ccache CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_MAXSIZE=2G
      CCACHE_SLOPPINESS=pch_defines,time_macros ${DAPPLE_CCACHE})
endif()

# Two fifths of the compile time of a source are headers of Eigen, oneTBB and the standard library.
if(PROJECT_IS_TOP_LEVEL AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  set(fast_compile ON)
else()
  set(fast_compile OFF)
endif()
option(DAPPLE_FAST_COMPILE "Precompile headers of other libraries, and compile several sources at once where that is faster" ${fast_compile})

add_library(dapple_compiler INTERFACE)
target_compile_features(dapple_compiler INTERFACE cxx_std_20)
if(MSVC)
  target_compile_options(dapple_compiler INTERFACE /W4 $<$<BOOL:${DAPPLE_WERROR}>:/WX> /fp:precise /permissive- /utf-8
                         /bigobj)  # CGAL's and Eigen's templates
  # OpenMesh's headers ask for both, as those of the system have macros named min and max, and M_PI only on demand.
  target_compile_definitions(dapple_compiler INTERFACE NOMINMAX _USE_MATH_DEFINES)
else()
  # Contraction is off: a fused multiply-add on one machine and not on another would change the bytes.
  target_compile_options(dapple_compiler INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion
                         -Wno-sign-conversion $<$<BOOL:${DAPPLE_WERROR}>:-Werror>
                         -ffp-contract=off $<$<PLATFORM_ID:Linux>:-fno-semantic-interposition>
                         $<$<BOOL:${DAPPLE_FAST_COMPILE}>:-fpch-preprocess>)  # for ccache
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(aarch64|arm64)$")
    target_compile_options(dapple_compiler INTERFACE "SHELL:-include ${PROJECT_SOURCE_DIR}/native/src/base/eigen_on_arm.hpp")
  endif()
endif()
if(DAPPLE_SANITIZE)
  # The sanitizers' own code makes GCC see uninitialized values where there are none.
  target_compile_options(dapple_compiler INTERFACE -fsanitize=${DAPPLE_SANITIZE} -fno-omit-frame-pointer
                         $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  target_link_options(dapple_compiler INTERFACE -fsanitize=${DAPPLE_SANITIZE})
  if(DAPPLE_SANITIZE STREQUAL "thread")  # base/hand_over.hpp says what oneTBB, which is left out, would tell it
    target_compile_options(dapple_compiler INTERFACE -fsanitize-ignorelist=${PROJECT_SOURCE_DIR}/scripts/tsan.ignore)
    target_compile_definitions(dapple_compiler INTERFACE DAPPLE_THREAD_SANITIZER)
  endif()
endif()
