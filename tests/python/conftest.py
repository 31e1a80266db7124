# SPDX-License-Identifier: GPL-3.0-or-later
import os
import sys
from pathlib import Path

import dapple3d as dapple
import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))

import shapes

ROOT = Path(__file__).parents[2]

try:
    from hypothesis import HealthCheck, configuration, settings
except ModuleNotFoundError:  # test_properties.py is skipped
    pass
else:
    configuration.set_hypothesis_home_dir(ROOT / "build" / "hypothesis")
    common = {"deadline": None, "suppress_health_check": list(HealthCheck)}
    settings.register_profile("usual", derandomize=True, database=None, max_examples=40, **common)
    settings.register_profile("thorough", max_examples=2000, print_blob=True, **common)
    settings.load_profile("usual")


@pytest.fixture(scope="session")
def root() -> Path:
    return ROOT


@pytest.fixture(scope="session")
def data() -> Path:
    """The folder of real meshes; the test is skipped where there is none."""
    folder = Path(os.environ.get("DAPPLE_DATA") or ROOT.parent / "shared" / "data")
    if not folder.is_dir():
        pytest.skip(f"{folder} is not there; set DAPPLE_DATA to the folder that holds meshes/")
    return folder


@pytest.fixture(scope="session")
def mesh() -> shapes.Mesh:
    return shapes.torus()


@pytest.fixture(scope="session")
def surface(mesh) -> dapple.Surface:
    return dapple.Surface(*mesh)


@pytest.fixture(scope="session")
def dense(mesh) -> dapple.Surface:
    return dapple.Surface(*mesh, 1.5 + mesh[0][:, 0])


@pytest.fixture(scope="session")
def samples(surface) -> dapple.Samples:
    return dapple.sample(surface, 300)


@pytest.fixture
def torus(tmp_path, mesh) -> Path:
    path = tmp_path / "torus.ply"
    dapple.write_mesh(path, *mesh)
    return path


@pytest.fixture
def archive(tmp_path, mesh) -> Path:
    """An npz with densities at vertices, faces and corners."""
    vertices, faces = mesh
    path = tmp_path / "torus.npz"
    sides = (vertices[faces][:, :, 0] > 0).astype(float)
    np.savez(
        path,
        vertices=vertices,
        faces=faces,
        smooth=1.5 + vertices[:, 0],
        half=sides.min(axis=1),
        jumps=sides,
        short=np.ones(7),
        negative=np.full(len(vertices), -1.0),
    )
    return path
