# SPDX-License-Identifier: GPL-3.0-or-later
set(VCPKG_TARGET_ARCHITECTURE x64)
set(VCPKG_CRT_LINKAGE static)
set(VCPKG_LIBRARY_LINKAGE static)
set(VCPKG_BUILD_TYPE release)

# Boost has numbers for it too.
if(PORT STREQUAL "cgal")
  set(VCPKG_CMAKE_CONFIGURE_OPTIONS -DCGAL_DISABLE_GMP=ON)
endif()

# One instruction set, as others only make it larger: point queries gain nothing from them.
if(PORT STREQUAL "embree")
  set(VCPKG_CMAKE_CONFIGURE_OPTIONS -DEMBREE_MAX_ISA=SSE2)
endif()
