// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// OpenMesh's headers are not clean under the warnings used here, and its own order matters: readers
// before kernels.
#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

namespace dapple {

struct DoubleTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};
using HalfEdgeMesh = OpenMesh::TriMesh_ArrayKernelT<DoubleTraits>;
using PolygonMesh = OpenMesh::PolyMesh_ArrayKernelT<DoubleTraits>;

}  // namespace dapple
