# SPDX-License-Identifier: GPL-3.0-or-later
"""Files damaged at random, a few for each reader; tests/fuzz/files.py looks for longer."""

import sys
from pathlib import Path
from random import Random

import pytest

sys.path.append(str(Path(__file__).parents[1] / "fuzz"))
pytest.importorskip("PIL", reason="Pillow is not installed")
pytest.importorskip("DracoPy", reason="DracoPy is not installed")
from damage import damaged
from files import READERS, trouble, whole_files

SEEDS = range(20)


@pytest.mark.filterwarnings("ignore")  # Pillow and numpy warn about damaged files
@pytest.mark.parametrize("name", [reader.name for reader in READERS])
def test_damaged_files_are_read_or_refused(tmp_path, name):
    for reader, file, content in list(whole_files(tmp_path)):
        if reader.name != name:
            continue
        for seed in SEEDS:
            path = tmp_path / f"damaged{Path(file).suffix}"
            path.write_bytes(damaged(content, path.suffix, Random(f"{file} {seed}")))
            assert not trouble(reader, path), f"{file}, seed {seed}"
