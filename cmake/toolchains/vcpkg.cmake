# SPDX-License-Identifier: GPL-3.0-or-later
# Builds the Python package on Linux, Windows or macOS with libraries that vcpkg makes for it, as static ones:
#   VCPKG_ROOT=FOLDER python -m build --wheel -Ccmake.toolchain-file=cmake/toolchains/vcpkg.cmake
# FOLDER is a checkout of vcpkg, by default build/vcpkg. What is made of it lies in build/vcpkg-installed, for every Python.
get_filename_component(dapple_root ${CMAKE_CURRENT_LIST_DIR}/../.. ABSOLUTE)
set(dapple_vcpkg ${dapple_root}/build/vcpkg)
if(DEFINED ENV{VCPKG_ROOT})
  file(TO_CMAKE_PATH "$ENV{VCPKG_ROOT}" dapple_vcpkg)
endif()
set(VCPKG_MANIFEST_DIR ${dapple_root}/packaging/wheels)
set(VCPKG_INSTALLED_DIR ${dapple_root}/build/vcpkg-installed)
set(CGAL_DISABLE_GMP ON CACHE BOOL "Boost's numbers instead")
# As packaging/wheels/triplets/x64-windows.cmake: a Python comes without the run-time library of C++.
set(CMAKE_MSVC_RUNTIME_LIBRARY MultiThreaded CACHE STRING "Within the module")
include(${dapple_vcpkg}/scripts/buildsystems/vcpkg.cmake)
