// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/projector.hpp>

#if DAPPLE_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <Eigen/Geometry>
#include <memory>
#include <stdexcept>
#include <vector>

#include "surface/ordered_surface.hpp"

namespace dapple {

/// Embree stores the surface in single precision, scaled to [-1, 1]. The error of a coordinate is
/// at most 2^-24, that of a distance a few times as much. All faces within this margin of the best
/// distance are compared in double precision.
constexpr double kEmbreeMargin = 2e-6;
/// Distance from the center, in sizes of the surface, beyond which only the direction of a point
/// matters.
constexpr double kEmbreeFar = 1e12;

/// \param device null for errors in its creation
/// \throw Cancelled if Embree was stopped; std::bad_alloc, std::runtime_error for other failures
void check_embree(RTCDevice device);

/// Owns an object of Embree and releases it.
template <typename T, void (*Release)(T)>
class EmbreeHandle {
 public:
  /// \param device the device that created it; null for a device itself
  explicit EmbreeHandle(T handle, RTCDevice device = nullptr) : handle_(handle) {
    if (handle_) return;
    check_embree(device);
    throw std::runtime_error("Embree could not be set up");
  }
  EmbreeHandle(const EmbreeHandle&) = delete;
  EmbreeHandle& operator=(const EmbreeHandle&) = delete;
  ~EmbreeHandle() { Release(handle_); }
  [[nodiscard]] T get() const { return handle_; }

 private:
  T handle_;
};

/// The faces of a surface in Embree, in parts that are small enough for single precision.
struct Projector::Scene {
  /// A part of the faces, which Embree stores relative to the center of the part.
  struct Part {
    Part(const Scene& scene, std::vector<OrderedFace> faces, const Eigen::AlignedBox3d& box);

    [[nodiscard]] Vec3 to_unit(const Vec3& p) const { return (p - center) / scale; }
    [[nodiscard]] double squared_distance(const Vec3& p, double unit) const {
      return (unit * (low - p).cwiseMax(p - high).cwiseMax(0.0)).squaredNorm();
    }
    void attach_triangles(const Scene& scene, const Context* context);
    void build(const Scene& scene, const Context* context);

    std::vector<OrderedFace> faces;  // by Embree's index
    EmbreeHandle<RTCScene, rtcReleaseScene> handle;
    Vec3 low, high, center;
    double scale = 0.0;
  };

  Scene(const Surface& s, bool support_only, const Context* context);

  [[nodiscard]] Vec3 within_reach(const Vec3& p) const;
  void find_faces(bool support_only, const Context* context);
  void find_size(const Context* context);
  void split(std::vector<OrderedFace> some, const Context* context);
  void split(std::vector<OrderedFace> some, const Eigen::AlignedBox3d& box, const Context* context);
  void add_part(std::vector<OrderedFace> some, const Eigen::AlignedBox3d& box,
                const Context* context);
  [[nodiscard]] double mean_area(std::span<const OrderedFace> some) const;
  [[nodiscard]] bool is_fine(double area, double length) const;

  Surface surface;
  std::vector<OrderedFace> faces;  // of all parts
  EmbreeHandle<RTCDevice, rtcReleaseDevice> device{rtcNewDevice(nullptr)};
  std::vector<std::unique_ptr<Part>> parts;
  Eigen::AlignedBox3d box;
  Vec3 center;
  double scale;
  double factor;  // a power of two, about 1 / scale: squares of scaled lengths do not overflow
};

}  // namespace dapple
