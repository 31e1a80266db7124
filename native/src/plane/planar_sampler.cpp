// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/planar_sampler.hpp>

#include "base/validate.hpp"
#include "sample/outcome.hpp"
#include "sample/solve_classes.hpp"

namespace dapple {
namespace {

std::string shape(const Image& image) {
  return std::to_string(image.rows) + " x " + std::to_string(image.columns);
}

/// The density of class c as an image of this shape.
const Image& image_of(const FlatDomain& domain, const SampleClass& member, const Image& ones) {
  if (member.image) return *member.image;
  return domain.density() ? *domain.density() : ones;
}

const Image* first_image(std::span<const SampleClass> classes) {
  for (const SampleClass& member : classes)
    if (member.image) return &*member.image;
  return nullptr;
}

/// Sum of the classes' images, each scaled to its count.
Image union_image(const FlatDomain& domain, std::span<const SampleClass> classes,
                  const std::vector<double>& weights) {
  Image sum = *first_image(classes);
  Image ones = sum;
  ones.values.assign(ones.values.size(), 1.0);
  sum.values.assign(sum.values.size(), 0.0);
  for (std::size_t c = 0; c < classes.size(); ++c) {
    const Image& own = image_of(domain, classes[c], ones);
    if (own.rows != sum.rows || own.columns != sum.columns)
      throw ArgumentError("density of class " + std::to_string(c) + " is " + shape(own) +
                          " pixels, another is " + shape(sum) + ": all must be of one shape");
    for (std::size_t k = 0; k < sum.values.size(); ++k) sum.values[k] += weights[c] * own.values[k];
  }
  return sum;
}

ClassProblem planar_classes(const FlatDomain& domain, std::span<const SampleClass> classes,
                            Cells cells) {
  if (classes.empty()) throw ArgumentError("classes is empty: at least one is needed");
  for (std::size_t c = 0; c < classes.size(); ++c)
    if (classes[c].surface)
      throw ArgumentError(
          entry("classes", c) +
          ".surface is given: in a flat domain a class has its density as an image");
  const std::shared_ptr<const FlatDomain> own = domain.with_cells(cells);
  ClassProblem problem{own, {}};
  std::size_t filled = 0;
  for (const SampleClass& member : classes) {
    const std::shared_ptr<const Domain> mine =
        member.image
            ? std::shared_ptr<const Domain>(domain.with_density(*member.image)->with_cells(cells))
            : own;
    problem.classes.push_back({mine, member.count, member.radius, member.locked});
    filled += member.count > 0 ? 1 : 0;
    if (member.count > 0) problem.all = mine;
  }
  if (filled > 1)
    problem.all =
        first_image(classes)
            ? std::shared_ptr<const Domain>(
                  domain.with_density(union_image(domain, classes, union_weights(problem)))
                      ->with_cells(cells))
            : own;
  return problem;
}

}  // namespace

PlanarSamples sample(const FlatDomain& domain, std::size_t count, const SampleOptions& options,
                     Context* context) {
  const SampleClass all{.count = count, .locked = options.locked};
  return sample_classes(domain, {&all, 1}, options_of_one(options), context);
}

PlanarSamples sample_classes(const FlatDomain& domain, std::span<const SampleClass> classes,
                             const ClassOptions& options, Context* context) {
  return sampled(
      options, context, [&] { return planar_classes(domain, classes, options.sample.cells); },
      [&](const ClassMinimum& found) {
        const Sites& sites = found.minimum.state.sites;
        PlanarSamples result;
        for (const Vec3& x : sites.positions) result.positions.push_back(domain.canonical(x));
        result.classes = found.objective.classes;
        result.report = to_report(found.objective, found.minimum, classes.size(),
                                  std::vector<Vec3>(sites.size(), Vec3::UnitZ()));
        return result;
      });
}

}  // namespace dapple
