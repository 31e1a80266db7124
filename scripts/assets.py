# SPDX-License-Identifier: GPL-3.0-or-later
"""Write node groups and ready scatters as assets: python scripts/assets.py -- FILE.blend

Also in a Blender executable: blender --background --python scripts/assets.py -- FILE.blend
The same assets give the same bytes. The file is compressed by gzip, which every Blender reads.
"""

import gzip
import os
import sys
import tempfile
from pathlib import Path

import bpy

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

import addon  # noqa: E402 - found from now on
from addon.nodes import assets  # noqa: E402
from scripts.ready_scatters import READY, build  # noqa: E402
from scripts.settle_blend import settled  # noqa: E402


def main(path: Path) -> None:
    """Write the file, from an empty one."""
    addon.register()  # for the properties of scatters
    bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
    with tempfile.TemporaryDirectory() as folder:
        written = Path(folder, path.name)
        assets.write(str(written), {build(ready) for ready in READY})
        data = settled(written.read_bytes())
    path.write_bytes(gzip.compress(data, mtime=0))
    print(f"{path}: {len(assets.ASSETS)} node groups, {len(READY)} scatters")


if __name__ == "__main__":
    main(Path(sys.argv[sys.argv.index("--") + 1]))
    sys.stdout.flush()
    os._exit(0)  # at its ordinary end Blender may hang
