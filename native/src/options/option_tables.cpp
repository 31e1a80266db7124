// SPDX-License-Identifier: GPL-3.0-or-later
// Made by scripts/option_headers.py from the options structs: change those.
#include <dapple/option_tables.hpp>

namespace dapple {

void check_options(const LineOptions& options) { check_ranges(options); }
void check_options(const MosaicOptions& options) { check_ranges(options); }
void check_options(const OptimizerOptions& options) { check_ranges(options); }
void check_options(const TrackerOptions& options) { check_ranges(options); }
void check_options(const PopulationOptions& options) { check_ranges(options); }
void check_options(const ImageOptions& options) { check_ranges(options); }
void check_options(const RelaxOptions& options) { check_ranges(options); }
void check_options(const RemeshOptions& options) { check_ranges(options); }
void check_options(const ResampleOptions& options) { check_ranges(options); }
void check_options(const SampleOptions& options) { check_ranges(options); }
void check_options(const ClassOptions& options) { check_ranges(options); }
void check_options(const StippleOptions& options) { check_ranges(options); }
void check_options(const SymmetryOptions& options) { check_ranges(options); }
void check_options(const WindowOptions& options) { check_ranges(options); }

}  // namespace dapple
