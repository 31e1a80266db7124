// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The compiler includes it before anything else where the processor is an Arm. Eigen takes fused
// multiply-adds wherever the processor says that it has them; they round once, the x86-64 code of
// this library twice. The intrinsics themselves have to stay, so they are declared first.
#include <arm_neon.h>
#undef __ARM_FEATURE_FMA
