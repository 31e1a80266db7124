# SPDX-License-Identifier: GPL-3.0-or-later
"""Random walks over the whole package: see walks.py.

The same 200 each time; DAPPLE_THOROUGH=1 makes them 5,000, DAPPLE_WALKS any number.
"""

import os

import pytest

pytest.importorskip("hypothesis")

from walks import fault_of

PARTS = 8
COUNT = int(os.environ.get("DAPPLE_WALKS") or (5000 if os.environ.get("DAPPLE_THOROUGH") else 200))


@pytest.mark.parametrize("part", range(PARTS))
def test_nothing_goes_wrong_on_a_walk(part: int) -> None:
    faults = [fault for seed in range(part, COUNT, PARTS) if (fault := fault_of(seed))]
    assert not faults, "\n\n".join([f"{len(faults)} walks went wrong", *faults])
