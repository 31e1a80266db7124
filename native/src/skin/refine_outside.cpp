// SPDX-License-Identifier: GPL-3.0-or-later
#include <tbb/concurrent_hash_map.h>

#include <algorithm>
#include <cmath>
#include <dapple/exposure.hpp>
#include <functional>

#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/triangle.hpp"
#include "base/validate.hpp"
#include "density/pieces.hpp"
#include "skin/cut_at_crossings.hpp"
#include "skin/sky.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr double kJoined = 0.2, kCut = 0.6;  // shares of the progress
constexpr double kCoarse = 8.0;              // longest edge of pieces that are tested, in `edge`
constexpr double kFew = 1e-4;     // of the surface's area: smaller pieces are not cut unasked
constexpr double kInset = 0.2;    // of `edge`: distance of samples from what is hidden
constexpr double kCorner = 0.85;  // share of a corner in the place that is tested near it

struct Triangle {
  std::array<Vec3, 3> corners;

  [[nodiscard]] Vec3 center() const { return (corners[0] + corners[1] + corners[2]) / 3.0; }
  [[nodiscard]] Vec3 normal() const {
    return (corners[1] - corners[0]).cross(corners[2] - corners[0]).stableNormalized();
  }
  /// The places of the triangle that are tested: near its corners, where it may reach under
  /// another part, and the center.
  [[nodiscard]] std::array<Vec3, 4> places() const {
    const Vec3 middle = center();
    return {between(middle, corners[0], kCorner), between(middle, corners[1], kCorner),
            between(middle, corners[2], kCorner), middle};
  }
};

/// How much of a piece is hidden, as far as its places tell.
enum class Extent : char { kNothing, kPart, kAll };

/// The hidden parts of pieces. What was found for a piece that may be cut is kept, because it is
/// looked at once more in the end.
class Hidden {
 public:
  Hidden(const Surface& surface, double openness, const Context* context)
      : sky_(surface, context), openness_(openness) {}

  /// \param face the caller's face of the surface that the piece is of
  /// \param key  its corners in that face
  [[nodiscard]] Extent extent(const Triangle& triangle, std::int32_t face,
                              const std::array<Vec3, 3>& key) {
    const Key known{face, key};
    if (Found::const_accessor entry; found_.find(entry, known)) return entry->second;
    const Extent result = look(triangle, face);
    found_.insert({known, result});
    return result;
  }

  /// Whether anything of a piece is hidden. Most of what is hidden is so at its first place.
  [[nodiscard]] bool any(const Triangle& triangle, std::int32_t face,
                         const std::array<Vec3, 3>& key) const {
    if (Found::const_accessor entry; found_.find(entry, Key{face, key}))
      return entry->second != Extent::kNothing;
    const Vec3 normal = triangle.normal();
    const auto places = triangle.places();
    return std::any_of(places.begin(), places.end(),
                       [&](const Vec3& place) { return is_hidden(place, normal, face); });
  }

 private:
  struct Key {
    std::int32_t face;
    std::array<Vec3, 3> corners;
  };
  struct Compare {
    static std::size_t hash(const Key& key) {
      std::size_t result = std::hash<std::int32_t>()(key.face);
      for (const Vec3& corner : key.corners)
        for (Eigen::Index k = 0; k < 3; ++k)
          result = 0x9e3779b97f4a7c15u * (result ^ std::hash<double>()(corner[k]));
      return result;
    }
    static bool equal(const Key& a, const Key& b) {
      return a.face == b.face && a.corners == b.corners;
    }
  };
  using Found = tbb::concurrent_hash_map<Key, Extent, Compare>;

  [[nodiscard]] Extent look(const Triangle& triangle, std::int32_t face) const {
    const Vec3 normal = triangle.normal();
    const auto places = triangle.places();
    const bool first = is_hidden(places[0], normal, face);
    for (std::size_t k = 1; k < places.size(); ++k)
      if (is_hidden(places[k], normal, face) != first) return Extent::kPart;
    return first ? Extent::kAll : Extent::kNothing;
  }

  [[nodiscard]] bool is_hidden(const Vec3& place, const Vec3& normal, std::int32_t face) const {
    return !sky_.sees(place, normal, face, openness_) || sky_.is_covered(place, face);
  }

  Sky sky_;
  double openness_;
  Found found_;
};

/// The corners in the parent of a parent's piece.
std::array<Vec3, 3> corners_within(const std::array<Vec3, 3>& piece,
                                   const std::array<Vec3, 3>& in_piece) {
  return {combined(piece, in_piece[0]), combined(piece, in_piece[1]), combined(piece, in_piece[2])};
}

/// A refined surface of which pieces are tested, as it is in some pose.
struct Tested {
  const Refined& refined;
  Hidden& hidden;
  /// Leaves out faces without a density: they are hidden in an earlier pose.
  bool again = false;

  [[nodiscard]] bool is_left_out(std::int32_t face) const {
    const OrderedSurface& mesh = refined.surface.ordered();
    return again && mesh.densities(mesh.ordered_face(face)).isZero(0.0);
  }
};

/// Cut a surface until pieces are hidden or seen as a whole.
Refined cut_where_hidden(const Tested& tested, const OutsideOptions& options, Context* context) {
  const Refined& joined = tested.refined;
  const double coarse = std::max(kCoarse * options.edge, std::sqrt(kFew * joined.surface.area()));
  return refine(
      joined.surface,
      [&](const Piece& piece) {
        if (tested.is_left_out(piece.parent)) return EdgeMarks{};
        const EdgeMarks marks = longer_than(coarse, piece.corners);
        if (marks != EdgeMarks{}) return marks;
        const EdgeMarks cut = longer_than(options.edge, piece.corners);
        if (cut == EdgeMarks{}) return cut;
        const auto parent = static_cast<std::size_t>(piece.parent);
        const Extent extent =
            tested.hidden.extent({piece.corners}, joined.parents[parent],
                                 corners_within(joined.barycentric[parent], piece.barycentric));
        return extent == Extent::kPart ? cut : EdgeMarks{};
      },
      options.max_faces, context);
}

std::vector<std::uint8_t> hidden_faces(const Tested& tested, Context* context) {
  const Refined& refined = tested.refined;
  const std::vector<Vec3> vertices = refined.surface.vertices();
  const std::vector<Face> faces = refined.surface.faces();
  std::vector<std::uint8_t> result(faces.size(), 0);
  parallel_chunks(faces.size(), 256, [&](std::size_t begin, std::size_t end) {
    check_context(context);
    for (std::size_t f = begin; f < end; ++f) {
      if (tested.is_left_out(static_cast<std::int32_t>(f))) continue;
      Triangle triangle;
      for (std::size_t k = 0; k < 3; ++k)
        triangle.corners[k] = vertices[static_cast<std::size_t>(faces[f][k])];
      result[f] = tested.hidden.any(triangle, refined.parents[f], refined.barycentric[f]) ? 1 : 0;
    }
  });
  return result;
}

/// Remove the density of hidden faces of a surface that was cut for that.
void take_hidden(Refined& refined, std::span<const std::uint8_t> hidden, Context* context) {
  const std::vector<double> density = density_without(refined.surface, hidden);
  if (density.empty())
    throw ArgumentError(
        "nothing of the surface with a density is seen from outside: openness is too large, or "
        "another part encloses it");
  refined.surface = refined.surface.with_density({DensityAt::kCorners, density}, context);
}

/// Also remove the density of what is hidden in a pose of the surface.
Refined without_hidden_in(const Refined& refined, std::span<const Vec3> pose,
                          const OutsideOptions& options, Context* context) {
  Stretch cutting(context, 0.0, kCut), looking(context, kCut, 1.0);
  const Refined moved = refined.deformed(pose);
  Hidden hidden(moved.original, options.openness, cutting.context());
  const Refined fine = cut_where_hidden({moved, hidden, true}, options, cutting.context());
  Refined there = moved.then(fine);
  take_hidden(there, hidden_faces({there, hidden, true}, looking.context()), looking.context());
  Refined result = there.deformed(refined.original.vertices());
  result.original = refined.original;
  if (refined.surface.has_normals())
    result.surface =
        result.surface.with_normals(carried_normals(refined.original, result, looking.context()));
  if (context) context->advance(1.0);
  return result;
}

/// Without what is hidden where the surface is.
Refined without_hidden(const Surface& surface, const OutsideOptions& options, Context* context) {
  Stretch joining(context, 0.0, kJoined), cutting(context, kJoined, kCut);
  const Refined joined = cut_at_crossings(surface, joining.context());
  Hidden hidden(surface, options.openness, cutting.context());
  const Refined fine = cut_where_hidden({joined, hidden}, options, cutting.context());
  Refined result = joined.then(fine);
  Stretch looking(context, kCut, 1.0);
  take_hidden(result, hidden_faces({result, hidden}, looking.context()), looking.context());
  // At a joint itself a sample would lie on both parts, and be seen or not by rounding.
  result.inset = kInset * options.edge;
  if (context) context->advance(1.0);
  return result;
}

void check_options(const Surface& surface, const OutsideOptions& options) {
  if (!(options.openness >= 0.0 && options.openness <= 1.0))
    throw ArgumentError("openness is " + number(options.openness) + ": it must be in 0..1");
  check_positive("edge", options.edge);
  for (std::size_t k = 0; k < options.poses.size(); ++k) {
    const std::string name = "poses[" + std::to_string(k) + "]";
    check_same_length(name.c_str(), options.poses[k].size(), "the surface", surface.vertex_count());
    check_finite(name.c_str(), options.poses[k]);
  }
}

}  // namespace

Refined refine_outside(const Surface& surface, const OutsideOptions& options, Context* context) {
  check_options(surface, options);
  const std::size_t poses = options.poses.size();
  Stretch own(context, 0, poses + 1);
  Refined result = without_hidden(surface, options, own.context());
  for (std::size_t k = 0; k < poses; ++k) {
    Stretch other(context, k + 1, poses + 1);
    result = without_hidden_in(result, options.poses[k], options, other.context());
  }
  if (context) context->advance(1.0);
  return result;
}

}  // namespace dapple
