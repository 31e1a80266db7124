// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/forecast.hpp"

#include <algorithm>
#include <cmath>

namespace dapple {
namespace {

constexpr double kToRestore = 4.0;  // evaluations that restoring a frame takes
constexpr double kAlmost =
    0.8;  // share of the expected number, after which the progress slows down
constexpr int kRememberedLeast = 3;  // smallest number of decreases used for the forecast
constexpr int kRememberedPart = 2;   // the forecast uses 1 / kRememberedPart of all decreases
constexpr double kLeast = 1e-9;      // relative decrease below which only rounding remains

}  // namespace

Forecast::Forecast(const OptimizerOptions& options, double tolerance, bool restoring)
    : law_(options.method == Method::kTrustRegion ? kTrustRegion : kLineSearch),
      tolerance_(tolerance),
      most_(std::max(options.max_evaluations, 1)) {
  if (restoring) {
    most_ = std::min(most_, kToRestore);
    tolerance_ = 0.0;
  }
}

void Forecast::note(int evaluations, double decrease) {
  logs_.push_back(std::log(std::max({decrease, tolerance_, kLeast})) +
                  law_.power * std::log(evaluations));
}

double Forecast::evaluations() const {
  if (!(tolerance_ > 0.0)) return most_;
  const std::size_t last = std::min(
      logs_.size(), std::max<std::size_t>(kRememberedLeast, logs_.size() / kRememberedPart));
  double sum = logs_.empty() ? std::log(law_.first) : 0.0;
  for (std::size_t k = logs_.size() - last; k < logs_.size(); ++k) sum += logs_[k];
  const double c = std::exp(sum / static_cast<double>(std::max<std::size_t>(last, 1)));
  return std::min(most_, std::max(1.0, std::pow(c / tolerance_, 1.0 / law_.power)));
}

double Forecast::progress(int evaluations) const {
  const double share = static_cast<double>(evaluations) / this->evaluations();
  if (share <= kAlmost) return share;
  return 1.0 - (1.0 - kAlmost) * std::exp((kAlmost - share) / (1.0 - kAlmost));
}

double expected_evaluations(const OptimizerOptions& options) {
  return Forecast(options, options.tolerance, /*restoring=*/false).evaluations();
}

}  // namespace dapple
