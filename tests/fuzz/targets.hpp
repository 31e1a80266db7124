// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "bytes.hpp"

namespace dapple::fuzz {

// One for each family of verbs: takes its input from the bytes and expects of the results what
// holds for all of them.

void fuzz_surface(Bytes& bytes);
void fuzz_sample(Bytes& bytes);
void fuzz_symmetric(Bytes& bytes);
void fuzz_classes(Bytes& bytes);
void fuzz_resample(Bytes& bytes);
void fuzz_relax(Bytes& bytes);
void fuzz_tracker(Bytes& bytes);
void fuzz_population(Bytes& bytes);
void fuzz_planar(Bytes& bytes);
void fuzz_stipple(Bytes& bytes);
void fuzz_mosaic(Bytes& bytes);
void fuzz_remesh(Bytes& bytes);
void fuzz_decals(Bytes& bytes);
void fuzz_refine(Bytes& bytes);
void fuzz_spectrum(Bytes& bytes);
void fuzz_readers(Bytes& bytes);

struct Target {
  const char* name;
  void (*run)(Bytes& bytes);
};

inline constexpr std::array<Target, 16> kTargets = {{{"surface", fuzz_surface},
                                                     {"sample", fuzz_sample},
                                                     {"symmetric", fuzz_symmetric},
                                                     {"classes", fuzz_classes},
                                                     {"resample", fuzz_resample},
                                                     {"relax", fuzz_relax},
                                                     {"tracker", fuzz_tracker},
                                                     {"population", fuzz_population},
                                                     {"planar", fuzz_planar},
                                                     {"stipple", fuzz_stipple},
                                                     {"mosaic", fuzz_mosaic},
                                                     {"remesh", fuzz_remesh},
                                                     {"decals", fuzz_decals},
                                                     {"refine", fuzz_refine},
                                                     {"spectrum", fuzz_spectrum},
                                                     {"readers", fuzz_readers}}};

}  // namespace dapple::fuzz
