# SPDX-License-Identifier: GPL-3.0-or-later
# Any from 3.4 on: asked for a version, Eigen 5 would take 5 alone.
find_package(Eigen3 REQUIRED NO_MODULE)
if(Eigen3_VERSION VERSION_LESS 3.4)
  message(FATAL_ERROR "Eigen ${Eigen3_VERSION} is older than 3.4")
endif()
find_package(TBB REQUIRED CONFIG)
find_package(OpenMesh REQUIRED CONFIG)
find_package(nanoflann REQUIRED CONFIG)
find_package(CGAL REQUIRED CONFIG)
find_package(embree 4 CONFIG QUIET)
if(NOT embree_FOUND)
  find_package(embree 3 REQUIRED CONFIG)
endif()
