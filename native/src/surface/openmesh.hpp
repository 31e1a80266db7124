// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// OpenMesh's headers are not clean under the warnings used here.
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/System/omstream.hh>

namespace dapple {

// Its messages about faces that do not fit are suppressed, because callers check the returned
// handles.
inline const bool kOpenMeshIsQuiet = (omerr().disable(), true);

struct DoubleTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};
using HalfEdgeMesh = OpenMesh::TriMesh_ArrayKernelT<DoubleTraits>;
using PolygonMesh = OpenMesh::PolyMesh_ArrayKernelT<DoubleTraits>;

}  // namespace dapple
