# SPDX-License-Identifier: GPL-3.0-or-later
"""What test_same_bytes.py computes: all named cases, and the hashes of their bytes."""

import byte_cases_frames  # noqa: F401  each module adds its cases
import byte_cases_samples  # noqa: F401
import byte_cases_surfaces  # noqa: F401
from byte_runs import CASES, hashes_of

__all__ = ["CASES", "hashes_of"]
