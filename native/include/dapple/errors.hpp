// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>

namespace dapple {

/// An invalid argument; the message names the argument, the rule and the first offender.
class ArgumentError : public std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// The arrays do not form a surface (bad index, non-finite number, negative density, no area).
class SurfaceError : public ArgumentError {
  using ArgumentError::ArgumentError;
};

/// A mesh file could not be read or written.
class FileError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The work was cancelled through its Context or Poll; nothing was changed.
class Cancelled : public std::runtime_error {
 public:
  Cancelled() : std::runtime_error("cancelled") {}
};

}  // namespace dapple
