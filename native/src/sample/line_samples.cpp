// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <dapple/errors.hpp>
#include <dapple/line_samples.hpp>
#include <queue>
#include <string>

#include "base/progress.hpp"
#include "base/random.hpp"
#include "base/validate.hpp"
#include "lines/line_sites.hpp"
#include "sample/timed_call.hpp"
#include "surface/corner_normals.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr double kVertexPart = 0.5;  // vertices of a mesh, by its faces
// Meshes of few faces are no scans. Their lines have no noise, and may be shorter than the spacing
// that vertices have on average: a beam is two triangles on each side.
constexpr std::size_t kFewFaces = 200;
constexpr double kFewScale = 1e-3;  // of the scale of rules, on such meshes
constexpr double kFound = 0.5;      // of the progress, when the lines are found
constexpr double kJitter = 0.5;     // of the distance: natural samples move by up to half of it

/// A chain measured by the density, which is linear along each edge.
class LineMeasure {
 public:
  LineMeasure(const OrderedSurface& mesh, const LineChain& chain) : mesh_(mesh), chain_(chain) {
    for (std::size_t e = 0; e < chain.half_edges.size(); ++e) {
      const auto [from, to] = densities(e);
      ends_.push_back(total() + 0.5 * (from + to) * along(e).norm());
    }
  }

  [[nodiscard]] double total() const { return ends_.empty() ? 0.0 : ends_.back(); }

  struct Place {
    std::int32_t half_edge;
    double share;  ///< from the half-edge's start
    Vec3 tangent;  ///< along the chain
  };

  /// The place that a part of the total is before.
  [[nodiscard]] Place at(double part) const {
    const auto found = std::ranges::upper_bound(ends_, part);
    auto e = static_cast<std::size_t>(found - ends_.begin());
    if (found == ends_.end()) e = last();
    const double share = share_at(e, part - (e > 0 ? ends_[e - 1] : 0.0));
    const std::int32_t h = chain_.half_edges[e];
    const bool forward = start_of(mesh_, h) == chain_.vertices[e];
    return {h, forward ? share : 1.0 - share, along(e).normalized()};
  }

 private:
  [[nodiscard]] Vec3 along(std::size_t e) const {
    return mesh_.vertex(chain_.vertices[e + 1]) - mesh_.vertex(chain_.vertices[e]);
  }
  /// At both ends of an edge of the chain.
  [[nodiscard]] std::pair<double, double> densities(std::size_t e) const {
    const std::int32_t h = chain_.half_edges[e];
    const Vec3 values = mesh_.densities(face_of(h)).cwiseMax(0.0);
    const double start = values[h % 3], end = values[(h + 1) % 3];
    return start_of(mesh_, h) == chain_.vertices[e] ? std::pair(start, end) : std::pair(end, start);
  }
  /// The share of an edge over which a part of the integral lies: the root of
  /// length * (a t + (b - a) t^2 / 2) = part, in the form that also holds for a = b.
  [[nodiscard]] double share_at(std::size_t e, double part) const {
    const auto [a, b] = densities(e);
    const double length = along(e).norm();
    if (!(length > 0.0)) return 0.0;
    const double x = part / length;
    const double below = a + std::sqrt(std::max(a * a + 2.0 * (b - a) * x, 0.0));
    return below > 0.0 ? std::clamp(2.0 * x / below, 0.0, 1.0) : 0.0;
  }
  /// The last edge that holds any of the integral.
  [[nodiscard]] std::size_t last() const {
    return static_cast<std::size_t>(std::ranges::lower_bound(ends_, total()) - ends_.begin());
  }

  const OrderedSurface& mesh_;
  const LineChain& chain_;
  std::vector<double> ends_;  // of the integral, up to the end of each edge
};

/// Numbers in proportion to the measures that sum to `count` (Sainte-Lague).
/// \param parts per line, how many parts more than samples it has
std::vector<std::size_t> apportioned(std::span<const double> measures, std::span<const int> parts,
                                     std::size_t count) {
  double total = 0.0;
  for (const double measure : measures) total += measure;
  std::vector<std::size_t> numbers;
  std::size_t given = 0;
  using Next = std::pair<double, std::ptrdiff_t>;  // priority, -line: ties go to the first line
  std::priority_queue<Next> next;
  const auto push = [&](std::size_t k) {
    next.push({measures[k] / (static_cast<double>(numbers[k]) + parts[k] + 0.5),
               -static_cast<std::ptrdiff_t>(k)});
  };
  for (std::size_t k = 0; k < measures.size(); ++k) {
    const double quota = static_cast<double>(count) * (measures[k] / total) - parts[k] - 1.0;
    numbers.push_back(static_cast<std::size_t>(std::max(quota, 0.0)));
    given += numbers[k];
    push(k);
  }
  for (; given < count; ++given) {
    const auto k = static_cast<std::size_t>(-next.top().second);
    next.pop();
    ++numbers[k];
    push(k);
  }
  return numbers;
}

class LineSampler {
 public:
  LineSampler(const Surface& surface, const LineOptions& options, const Context* context)
      : surface_(surface),
        mesh_(surface.ordered()),
        options_(options),
        lines_(surface, rules(surface, options), context),
        random_(options.seed) {
    if (lines_.chains().empty())
      throw ArgumentError(
          "surface has no lines: no borders, marked edges, or creases of more than " +
          std::to_string(static_cast<int>(options.feature_angle)) + " degrees");
    for (const LineChain& chain : lines_.chains()) {
      measures_.push_back(LineMeasure(mesh_, chain).total());
      parts_.push_back(options.corners && !chain.closed ? 1 : 0);
    }
    if (std::ranges::none_of(measures_, [](double measure) { return measure > 0.0; }))
      throw ArgumentError("density is 0 along all lines: it must be positive somewhere on them");
  }

  [[nodiscard]] LineSamples run(std::size_t count, Context* context) {
    const std::size_t corners = options_.corners ? lines_.corners().size() : 0;
    if (count < corners)
      throw ArgumentError("count is " + std::to_string(count) + ": there are " +
                          std::to_string(corners) + " corners, which get a sample each");
    if (corners > 0) add_corners();
    const std::vector<std::size_t> numbers = apportioned(measures_, parts_, count - corners);
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      check_context(context);
      add_line(k, numbers[k]);
      context->advance(kFound + (1.0 - kFound) * static_cast<double>(k + 1) /
                                    static_cast<double>(numbers.size()));
    }
    return finished();
  }

 private:
  static LineRules rules(const Surface& surface, const LineOptions& options) {
    const double vertices = kVertexPart * static_cast<double>(surface.face_count());
    const double share = surface.face_count() < kFewFaces ? kFewScale : 1.0;
    return {.feature_angle = options.feature_angle,
            .scale = share * surface.spacing(static_cast<std::size_t>(std::max(vertices, 1.0))),
            .marked = options.edges,
            .borders = options.borders};
  }

  void add(std::int32_t half_edge, double share, const Vec3& tangent, const Vec3& normal,
           std::int32_t line) {
    const Sites site = point_on_edge(mesh_, half_edge, share);
    faces_.push_back(site.faces[0]);
    barycentric_.push_back(site.barycentric[0]);
    normals_.push_back(normal.normalized());
    result_.tangents.push_back(tangent);
    result_.lines.push_back(line);
  }

  void add_line(std::size_t k, std::size_t number) {
    const LineChain& chain = lines_.chains()[k];
    const LineMeasure measure(mesh_, chain);
    const double distance = measure.total() / static_cast<double>(number + as_index(parts_[k]));
    for (std::size_t j = 0; j < number; ++j) {
      const double shift = options_.line_spacing == LineSpacing::kNatural
                               ? kJitter * (random_.uniform() - 0.5)
                               : 0.0;
      const double at = static_cast<double>(j) + (parts_[k] > 0 ? 1.0 : 0.5) + shift;
      const LineMeasure::Place place = measure.at(at * distance);
      add(place.half_edge, place.share, place.tangent, normal_at(place.half_edge),
          static_cast<std::int32_t>(k));
    }
  }

  [[nodiscard]] Vec3 normal_of(OrderedFace face) const {
    return lines_.sign(face) * mesh_.geometry(face).normal;
  }

  [[nodiscard]] Vec3 normal_at(std::int32_t half_edge) const {
    Vec3 sum = Vec3::Zero();
    for_each_half_edge(mesh_, half_edge, [&](std::int32_t h) { sum += normal_of(face_of(h)); });
    return sum;
  }

  /// Corners with the direction of their first line and the mean normal of their faces by angle.
  void add_corners() {
    std::vector<Vec3> normals(mesh_.vertex_count(), Vec3::Zero()), tangents = normals;
    for (std::size_t k = 0; k < 3 * surface_.face_count(); ++k) {
      const auto h = static_cast<std::int32_t>(k);
      if (mesh_.counts(face_of(h)))
        normals[as_index(start_of(mesh_, h))] += angle_at(mesh_, h) * normal_of(face_of(h));
    }
    for (const LineChain& chain : lines_.chains()) {
      const std::size_t n = chain.vertices.size();
      for (const auto& [at, from, to] :
           {std::array<std::size_t, 3>{0, 0, 1}, {n - 1, n - 2, n - 1}})
        if (Vec3& tangent = tangents[as_index(chain.vertices[at])]; tangent.isZero())
          tangent =
              (mesh_.vertex(chain.vertices[to]) - mesh_.vertex(chain.vertices[from])).normalized();
    }
    for (std::size_t k = 0; k < lines_.corners().size(); ++k) {
      const std::size_t v = as_index(lines_.corners()[k]);
      add(lines_.half_edge_at(k), 0.0, tangents[v], normals[v], -1);
    }
  }

  [[nodiscard]] LineSamples finished() {
    result_.samples = bind_samples(surface_, faces_, barycentric_);
    for (std::size_t k = 0; k < normals_.size(); ++k)
      if (!normals_[k].isZero()) result_.samples.normals[k] = normals_[k];
    double total = 0.0;
    for (const LineChain& chain : lines_.chains()) {
      result_.lengths.push_back(chain.length);
      total += chain.length;
    }
    result_.samples.report.spacing = total / static_cast<double>(faces_.size());
    return std::move(result_);
  }

  const Surface& surface_;
  const OrderedSurface& mesh_;
  const LineOptions& options_;
  FeatureLines lines_;
  Random random_;
  std::vector<double> measures_;  // per chain
  std::vector<int> parts_;        // per chain: how many more than samples
  std::vector<std::int32_t> faces_;
  std::vector<Vec3> barycentric_, normals_;
  LineSamples result_;
};

}  // namespace

LineSamples sample_lines(const Surface& surface, std::size_t count, const LineOptions& options,
                         Context* context) {
  TimedCall call(context);
  check_options(options);
  if (count == 0) throw ArgumentError("count is 0: it must be >= 1");
  check_count("count", count);
  if (context) context->check();
  LineSampler sampler(surface, options, call.context());
  call.context()->advance(kFound);
  LineSamples result = sampler.run(count, call.context());
  call.write(result.samples.report);
  if (context) context->advance(1.0);
  return result;
}

}  // namespace dapple
