# SPDX-License-Identifier: GPL-3.0-or-later
# Builds for one target of a release with the compiler and the libraries that scripts/dependencies.sh puts into
# build/ship: cmake -DCMAKE_TOOLCHAIN_FILE=cmake/toolchains/zig.cmake -DDAPPLE_TARGET=windows-x64
# DAPPLE_PYTHON_VERSION chooses the Python that the module is for: 3.11 or 3.13.
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES DAPPLE_TARGET DAPPLE_PYTHON_VERSION)
set(DAPPLE_TARGET "" CACHE STRING "linux-x64, linux-arm64, windows-x64, macos-arm64 or macos-x64")
set(DAPPLE_PYTHON_VERSION 3.11 CACHE STRING "The Python that the module is for")

if(NOT DAPPLE_TARGET MATCHES "^(linux|windows|macos)-(x64|arm64)$")
  message(FATAL_ERROR "DAPPLE_TARGET=${DAPPLE_TARGET}: it must be linux-x64, linux-arm64, windows-x64, macos-arm64 or macos-x64")
endif()
set(linux Linux)
set(windows Windows)
set(macos Darwin)
set(CMAKE_SYSTEM_NAME ${${CMAKE_MATCH_1}})
if(CMAKE_MATCH_2 STREQUAL x64)
  set(CMAKE_SYSTEM_PROCESSOR x86_64)
elseif(CMAKE_MATCH_1 STREQUAL linux)
  set(CMAKE_SYSTEM_PROCESSOR aarch64)
else()
  set(CMAKE_SYSTEM_PROCESSOR arm64)
endif()

get_filename_component(ship ${CMAKE_CURRENT_LIST_DIR}/../../build/ship/${DAPPLE_TARGET} ABSOLUTE)
set(CMAKE_C_COMPILER ${ship}/bin/clang)
set(CMAKE_CXX_COMPILER ${ship}/bin/clang++)
set(CMAKE_AR ${ship}/bin/ar CACHE FILEPATH "")
set(CMAKE_RANLIB ${ship}/bin/ranlib CACHE FILEPATH "")
set(CMAKE_RC_COMPILER ${ship}/bin/rc)
set(CMAKE_OSX_DEPLOYMENT_TARGET "" CACHE STRING "The wrapper of the compiler says it")
set(CMAKE_OSX_SYSROOT "" CACHE STRING "")
# Linking is tried nowhere: what the compilers can do is known, and configuring takes seconds.
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_TRY_COMPILE_CONFIGURATION Release)
# What is written past the end of an array ends the program instead of running on.
set(hardening "-fstack-protector-strong -U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=2")
set(CMAKE_C_FLAGS_INIT "-ffp-contract=off ${hardening}")
set(CMAKE_CXX_FLAGS_INIT "-ffp-contract=off ${hardening}")
foreach(kind EXE SHARED MODULE)
  set(CMAKE_${kind}_LINKER_FLAGS_INIT -s)
endforeach()

# All that is found was put there: nothing of the machine that builds.
set(CMAKE_FIND_ROOT_PATH ${ship}/prefix)
set(CMAKE_PREFIX_PATH /usr)
set(CMAKE_LIBRARY_ARCHITECTURE x86_64-linux-gnu) # of the packages whose headers are used, for any target
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CGAL_DISABLE_GMP ON CACHE BOOL "Boost's numbers instead")

# Python: headers alone, and on Windows a library of its functions' names.
set(PYBIND11_USE_CROSSCOMPILING ON)
string(REPLACE . "" digits ${DAPPLE_PYTHON_VERSION})
set(PYTHON_MODULE_DEBUG_POSTFIX "")
set(PYTHON_IS_DEBUG OFF)
set(Python_INCLUDE_DIR ${ship}/python${DAPPLE_PYTHON_VERSION}/include)
if(CMAKE_SYSTEM_NAME STREQUAL Windows)
  set(PYTHON_MODULE_EXTENSION .cp${digits}-win_amd64.pyd)
  set(Python_LIBRARY ${ship}/python${DAPPLE_PYTHON_VERSION}/python${digits}.lib)
elseif(CMAKE_SYSTEM_NAME STREQUAL Darwin)
  set(PYTHON_MODULE_EXTENSION .cpython-${digits}-darwin.so)
else()
  set(PYTHON_MODULE_EXTENSION .cpython-${digits}-${CMAKE_SYSTEM_PROCESSOR}-linux-gnu.so)
endif()
