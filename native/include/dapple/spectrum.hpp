// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/samples.hpp>
#include <vector>

namespace dapple {

/// Statistics of a quantity in the plane at each distance from the origin.
struct RadialStatistics {
  std::vector<double> radius;      ///< middle of each annulus
  std::vector<double> mean;        ///< over the annulus
  std::vector<double> anisotropy;  ///< variance / mean^2 over the annulus, in decibels; -infinity
                                   ///< where nothing varies
};

struct SpectrumOptions {
  int half_width = 0;  ///< largest frequency on either axis; 0: 3 sqrt(n), n the largest run's
  int threads = 0;     ///< 0: as many as the machine has
};

/// The spectrum of point sets on the unit torus or square, averaged over runs (Schloemer and
/// Deussen, Accurate Spectral Analysis of Two-Dimensional Point Sets, 2011).
struct Spectrum {
  std::size_t runs = 0;
  int half_width = 0;  ///< h: the frequencies are the integers -h..h on either axis
  /// (2h + 1)^2 powers |sum_k exp(-2 pi i f . x_k)|^2 / n, averaged over the runs, row by row from
  /// f_y = -h; 1 is white noise. The middle, f = 0, is n.
  std::vector<double> periodogram;
  /// Annulus k holds the frequencies with |f| in [k - 1/2, k + 1/2), k = 1..h, one of each pair
  /// f, -f. For white noise the mean is 1 and the anisotropy -10 log10(runs).
  RadialStatistics radial;
  double frequency_unit = 1.0;  ///< sqrt(n): the spectra of n and 4 n points agree in f / sqrt(n)
};

/// Compute the spectrum by direct Fourier sums; each run is a set of points (x, y).
/// \throw ArgumentError naming the first run without points, the first coordinate that is not
/// finite or outside [0, 1], a negative half width
/// \throw Cancelled
[[nodiscard]] Spectrum spectrum(std::span<const std::span<const Vec2>> runs,
                                const SpectrumOptions& options = {}, Context* context = nullptr);

struct SurfaceSpectrumOptions {
  double radius = 5.0;  ///< radius of the neighborhood, in spacings
  int bins = 128;       ///< of the differentials on either axis; even
  int threads = 0;      ///< 0: as many as the machine has
};

/// The spectrum of samples on a surface, from the differentials between them (Wei and Wang,
/// Differential Domain Analysis for Non-Uniform Sampling, 2011), averaged over runs.
///
/// The differential from p to q lies in the tangent plane at p: it has the direction of q - p
/// projected on the plane, and the approximate geodesic length of Bowers et al. (Parallel Poisson
/// Disk Sampling with Spectrum Analysis on Surfaces, 2010),
///   |q - p| (asin c_p - asin c_q) / (c_p - c_q),   c = n . (q - p) / |q - p|,
/// which is exact on spheres and in the plane. It is divided by the mean of the local spacings of p
/// and q, sqrt(2 M / (sqrt(3) n phi)) with the density phi and its integral M. Pairs whose normals
/// n_p and n_q point away from each other are not of one sheet and do not count. The first axis of
/// the tangent plane is the world's x axis projected on it, the second turns left from there: on
/// curved surfaces directions are only as comparable as these frames are.
struct SurfaceSpectrum {
  std::size_t runs = 0;
  std::size_t centers = 0;  ///< samples farther than the radius from any border, over all runs
  double radius = 0.0;      ///< in spacings
  int bins = 0;
  /// bins^2 values over [-radius, radius]^2, row by row from the lowest y: number of differentials
  /// that end there, relative to white noise (the pair correlation function). NaN where the middle
  /// of a bin lies beyond the radius.
  std::vector<double> differentials;
  RadialStatistics radial_differentials;  ///< over the annuli as wide as a bin, in spacings
  int half_width = 0;
  /// (2 half_width + 1)^2 powers as in Spectrum, but in steps of `frequency_step`:
  /// 1 + the Fourier transform of (pair correlation - 1), faded out toward the radius by
  /// cos^2(pi r / (2 radius)); white noise is 1, f = 0 is left at what the transform gives.
  std::vector<double> power;
  /// Over annuli as wide as a step. Estimates at near frequencies depend on each other, so white
  /// noise has no level of anisotropy to compare with, and where the mean is close to 0 what is
  /// left of the estimates' error makes the anisotropy large.
  RadialStatistics radial_power;
  double frequency_step = 0.0;  ///< in sqrt(n / A), the unit of Spectrum's f / sqrt(n)
};

/// \param runs samples of the same surface
/// \throw ArgumentError naming the first run with fewer than two samples, the first face that is
/// not of the surface, an option out of range, or that no sample is farther than the radius from
/// the border
/// \throw Cancelled
[[nodiscard]] SurfaceSpectrum surface_spectrum(const Surface& surface,
                                               std::span<const Samples* const> runs,
                                               const SurfaceSpectrumOptions& options = {},
                                               Context* context = nullptr);

}  // namespace dapple
