# SPDX-License-Identifier: GPL-3.0-or-later
"""USD files: what is written is read back, and is what USD's own tools take for valid."""

import subprocess
import sys

import numpy as np
import pytest
from dapple3d import instances
from dapple3d.extras import usd
from dapple3d.instances import Instances, Mesh, Reference, Scatter

pytest.importorskip("pxr", reason="usd-core is not installed")
from pxr import Gf, Usd, UsdGeom, UsdShade, UsdValidation


def rounded(values: np.ndarray) -> np.ndarray:
    """As USD holds them."""
    return values.astype(np.float32) if values.dtype.kind == "f" else values


def check_same(found: Instances, expected: Instances) -> None:
    assert found.arrays().keys() == expected.arrays().keys()
    for name, values in expected.arrays().items():
        np.testing.assert_array_equal(found.arrays()[name], rounded(values), name)


@pytest.fixture
def whole() -> Instances:
    """With all arrays, and an id that needs more than 32 bits."""
    random = np.random.default_rng(0)
    normals = random.normal(size=(50, 3))
    return Instances(
        random.normal(size=(50, 3)),
        instances.orientations(normals),
        random.uniform(0.5, 2, (50, 3)),
        random.normal(size=(50, 3)),
        normals,
        np.arange(50) + 2**40,
        np.arange(50, dtype=np.int32) // 30,
        np.arange(50, dtype=np.int32) % 3,
    )


@pytest.fixture
def motion(whole) -> list[Instances]:
    """Points move, then some are gone and others there."""
    rows = [slice(0, 40), slice(0, 40), slice(10, 50)]
    arrays = whole.arrays()
    return [
        Instances(
            **{name: values[row] for name, values in arrays.items()}
            | {"positions": whole.positions[row] + k}
        )
        for k, row in enumerate(rows)
    ]


@pytest.mark.parametrize("suffix", usd.SUFFIXES)
def test_all_arrays_come_back(tmp_path, whole, suffix):
    path = tmp_path / f"points{suffix}"
    usd.write(path, whole, up="Y", meters_per_unit=0.01, fps=30)
    found = usd.read(path)
    check_same(*found.frames, whole)
    assert (found.up, found.meters_per_unit, found.fps) == ("Y", 0.01, 30)
    assert found.times.tolist() == [0]
    assert len(found.prototypes) == 3


@pytest.mark.parametrize("suffix", usd.SUFFIXES)
def test_a_motion_with_points_that_come_and_go_comes_back(tmp_path, motion, suffix):
    path = tmp_path / f"points{suffix}"
    usd.write(path, motion, times=[11, 12, 20.5])
    found = usd.read(path)
    assert found.times.tolist() == [11, 12, 20.5]
    for one, expected in zip(found.frames, motion, strict=True):
        check_same(one, expected)


def test_a_frame_without_points_comes_back(tmp_path, whole):
    nothing = Instances(**{name: values[:0] for name, values in whole.arrays().items()})
    usd.write(tmp_path / "points.usdc", [nothing, whole])
    first, second = usd.read(tmp_path / "points.usdc").frames
    check_same(first, nothing)
    check_same(second, whole)


def test_other_programs_place_them_alike(tmp_path, whole):
    """By the matrices that USD computes, at all times and from 16-bit orientations too."""
    usd.write(tmp_path / "points.usda", whole)
    stage = Usd.Stage.Open(str(tmp_path / "points.usda"))
    prim = UsdGeom.PointInstancer(stage.GetPrimAtPath("/dapple/points"))
    places = np.array(prim.ComputeInstanceTransformsAtTime(0, 0))
    np.testing.assert_allclose(places[:, 3, :3], whole.positions, atol=1e-6)
    z = places[:, 2, :3] / whole.scales[:, 2:]
    unit = whole.normals / np.linalg.norm(whole.normals, axis=1, keepdims=True)
    np.testing.assert_allclose(z, unit, atol=1e-6)
    half = np.array(prim.GetOrientationsAttr().Get(), np.float64)
    np.testing.assert_allclose(half, np.roll(whole.orientations, -1, axis=1), atol=1e-3)


def test_what_stays_the_same_is_written_once(tmp_path, whole):
    moved = Instances(**whole.arrays() | {"positions": whole.positions + 1})
    usd.write(tmp_path / "points.usda", [whole, moved])
    stage = Usd.Stage.Open(str(tmp_path / "points.usda"))
    prim = stage.GetPrimAtPath("/dapple/points")
    sampled = [one.GetName() for one in prim.GetAttributes() if one.GetNumTimeSamples()]
    assert sorted(sampled) == ["extent", "positions", "velocities"]


def test_velocities_that_never_change_are_used(tmp_path):
    """USD ignores those without the times of the positions."""
    steps = [Instances(np.full((2, 3), float(k)), ids=[1, 2]) for k in range(3)]
    usd.write(tmp_path / "points.usda", instances.with_velocities(steps, 24))
    stage = Usd.Stage.Open(str(tmp_path / "points.usda"))
    prim = UsdGeom.PointInstancer(stage.GetPrimAtPath("/dapple/points"))
    assert prim.GetVelocitiesAttr().GetTimeSamples() == [1, 2, 3]
    places = np.array(prim.ComputeInstanceTransformsAtTime(3.5, 3))[:, 3, :3]
    np.testing.assert_allclose(places, 2.5)  # beyond the last sample


def test_usd_takes_the_file_for_valid(tmp_path, motion):
    usd.write(tmp_path / "ball.usda", motion[0])
    triangle = Mesh(np.eye(3), np.array([[0, 1, 2]]))
    reference = Reference(tmp_path / "ball.usda")
    path = tmp_path / "points.usdc"
    usd.write(path, motion, prototypes=[triangle, reference, triangle])
    rules = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    found = UsdValidation.ValidationContext(rules).Validate(Usd.Stage.Open(str(path)))
    assert len(rules) > 20
    assert [error.GetErrorAsString() for error in found] == []


def test_the_extent_holds_the_instances(tmp_path, whole):
    cube = np.stack(np.meshgrid([-1, 1], [-1, 1], [-1, 1]), -1).reshape(-1, 3)
    usd.write(tmp_path / "points.usdc", whole, prototypes=[Mesh(cube, [[0, 1, 2]])] * 3)
    stage = Usd.Stage.Open(str(tmp_path / "points.usdc"))
    extent = stage.GetPrimAtPath("/dapple/points").GetAttribute("extent")
    low, high = np.array(extent.Get())
    assert (low < whole.positions.min(axis=0)).all()
    assert (high > whole.positions.max(axis=0)).all()


def test_prototypes_lie_where_they_are_from_the_file(tmp_path, whole):
    (tmp_path / "plants").mkdir()
    (tmp_path / "shots").mkdir()
    usd.write(tmp_path / "plants" / "fern.usda", whole, name="leaves")
    fern = tmp_path / "plants" / "fern.usda"
    path = tmp_path / "shots" / "shot.usda"
    references = [Reference(fern), Reference(fern, "/dapple/leaves"), Reference(fern)]
    usd.write(path, whole, prototypes=references)
    assert "@../plants/fern.usda@</dapple/leaves>" in path.read_text()
    tmp_path.rename(moved := tmp_path.with_name(f"{tmp_path.name}-moved"))
    stage = Usd.Stage.Open(str(moved / "shots" / "shot.usda"))
    below = stage.GetPrimAtPath("/dapple/points/prototypes/class_0/leaves")
    assert below.IsA(UsdGeom.PointInstancer)
    check_same(*usd.read(moved / "shots" / "shot.usda").frames, whole)  # not the frames of the fern


def test_a_held_prototype_needs_its_file_no_more(tmp_path, whole):
    """What it is bound to comes along."""
    other = tmp_path / "plants.usda"
    stage = Usd.Stage.CreateNew(str(other))
    stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, "/plants").GetPrim())
    green = UsdShade.Material.Define(stage, "/plants/materials/green")
    for name in ("fern", "moss", "ivy"):
        plant = UsdGeom.Cube.Define(stage, f"/plants/{name}").GetPrim()
        UsdShade.MaterialBindingAPI.Apply(plant).Bind(green)
    stage.Save()
    held = [Reference(other, f"/plants/{name}", held=True) for name in ("moss", "fern", "ivy")]
    usd.write(tmp_path / "points.usdc", whole, prototypes=held)
    with pytest.raises(ValueError, match="prototypes has fern twice"):
        usd.write(tmp_path / "twice.usdc", whole, prototypes=[*held[:2], held[1]])
    other.unlink()
    paths = usd.read(tmp_path / "points.usdc").prototypes
    below = "/dapple/points/prototypes/plants"
    assert paths == (f"{below}/moss", f"{below}/fern", f"{below}/ivy")
    stage = Usd.Stage.Open(str(tmp_path / "points.usdc"))
    moss = stage.GetPrimAtPath(paths[0])
    bound, _ = UsdShade.MaterialBindingAPI(moss).ComputeBoundMaterial()
    assert bound.GetPath() == f"{below}/materials/green"


def test_several_scatters_share_a_file(tmp_path, whole, motion):
    scatters = [Scatter("grass", motion), Scatter("trees", [whole] * 3)]
    usd.write_scatters(tmp_path / "points.usda", scatters, times=[3, 4, 5])
    check_same(usd.read(tmp_path / "points.usda", "/dapple/grass").frames[2], motion[2])
    still = usd.read(tmp_path / "points.usda", "/dapple/trees")
    assert still.times.tolist() == [3, 4, 5]
    for frame in still.frames:
        check_same(frame, whole)
    with pytest.raises(ValueError, match="name is 'grass', which another scatter has too"):
        usd.write_scatters(tmp_path / "two.usda", [scatters[0], scatters[0]])
    with pytest.raises(ValueError, match=r"scatters have \[1, 3\] frames: the same number"):
        usd.write_scatters(tmp_path / "two.usda", [scatters[0], Scatter("rocks", [whole])])


def test_default_balls_do_not_touch(tmp_path, samples):
    usd.write(tmp_path / "points.usda", instances.of_samples(samples))
    stage = Usd.Stage.Open(str(tmp_path / "points.usda"))
    ball = UsdGeom.Sphere(stage.GetPrimAtPath("/dapple/points/prototypes/class_0"))
    gaps = np.linalg.norm(samples.positions[:, None] - samples.positions[None], axis=2)
    nearest = gaps[gaps > 0].min()
    assert 0.1 * nearest < ball.GetRadiusAttr().Get() < 0.5 * nearest


def test_files_of_other_programs_are_read(tmp_path):
    """With 16-bit orientations alone, nothing but the needed, and a prim above."""
    stage = Usd.Stage.CreateNew(str(tmp_path / "other.usda"))
    UsdGeom.Xform.Define(stage, "/world")
    other = UsdGeom.PointInstancer.Define(stage, "/world/trees")
    other.GetPositionsAttr().Set([(1, 2, 3), (4, 5, 6)])
    other.GetProtoIndicesAttr().Set([1, 0])
    other.GetOrientationsAttr().Set([Gf.Quath(1, 0, 0, 0), Gf.Quath(0, 1, 0, 0)])
    stage.Save()
    (frame,) = usd.read(tmp_path / "other.usda").frames
    assert frame.positions.tolist() == [[1, 2, 3], [4, 5, 6]]
    assert frame.orientations.tolist() == [[1, 0, 0, 0], [0, 1, 0, 0]]
    assert frame.classes.tolist() == [1, 0]
    assert frame.ids is None
    UsdGeom.PointInstancer.Define(stage, "/world/stones")
    stage.Save()
    with pytest.raises(ValueError, match=r"has 2 PointInstancers, name one.*/world/stones"):
        usd.read(tmp_path / "other.usda")
    assert len(usd.read(tmp_path / "other.usda", "/world/trees").frames[0]) == 2
    with pytest.raises(ValueError, match=r"has no PointInstancer /world, but /world/trees"):
        usd.read(tmp_path / "other.usda", "/world")
    with pytest.raises(ValueError, match=r"/world/stones has no positions"):
        usd.read(tmp_path / "other.usda", "/world/stones")


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"times": [1, 1, 2]}, "times is .*: 3 growing numbers are needed"),
        ({"times": [1, 2]}, "times is .*: 3 growing numbers are needed"),
        ({"fps": 0}, "fps is 0: a number > 0 is needed"),
        ({"meters_per_unit": np.nan}, "meters_per_unit is nan"),
        ({"up": "X"}, "up is 'X': Y or Z is needed"),
        ({"name": "my points"}, "name is 'my points': letters"),
        (
            {"prototypes": [Mesh(np.eye(3), [[0, 1, 2]])]},
            "prototypes has 1 of 3 entries",
        ),
    ],
)
def test_wrong_arguments_are_named_and_nothing_is_written(tmp_path, motion, given, said):
    with pytest.raises(ValueError, match=said):
        usd.write(tmp_path / "points.usda", motion, **given)
    assert list(tmp_path.iterdir()) == []


def test_wrong_frames_and_files_are_named(tmp_path, whole):
    path = tmp_path / "points.usda"
    with pytest.raises(ValueError, match="frames is empty"):
        usd.write(path, [])
    with pytest.raises(ValueError, match=r"frames\[1\] has \['positions'\], but frames\[0\]"):
        usd.write(path, [whole, Instances(whole.positions)])
    with pytest.raises(ValueError, match=r"positions\[1\] is no 32-bit float: \[1e\+40"):
        usd.write(path, Instances(np.array([[0.0, 0, 0], [1e40, 0, 0]])))
    with pytest.raises(ValueError, match=r"points.csv: a USD file ends with .usd, .usda, .usdc"):
        usd.write(tmp_path / "points.csv", whole)
    with pytest.raises(FileNotFoundError) as missing:
        usd.write(path, whole, prototypes=[Reference(tmp_path / "fern.usd")] * 3)
    assert missing.value.filename == str(tmp_path / "fern.usd")
    path.write_text("no USD")
    with pytest.raises(
        OSError, match=r"could not be read as USD: .* is not a valid usda layer"
    ) as broken:
        usd.read(path)
    assert broken.value.filename == str(path)


def test_without_usd_the_module_says_what_to_install(tmp_path):
    code = f"""
import sys
sys.modules["pxr"] = None
from dapple3d.extras import usd
try:
    usd.read({str(tmp_path / "points.usd")!r})
except ImportError as error:
    print(error)
"""
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout == usd.MISSING + "\n"


@pytest.mark.parametrize("suffix", usd.SUFFIXES)
@pytest.mark.parametrize("times", [[5], [-3.5], [0], [5, 6, 7], [1, 2]])
def test_still_frames_come_back_at_their_times(tmp_path, whole, suffix, times):
    usd.write(tmp_path / f"p{suffix}", [whole] * len(times), times=times)
    found = usd.read(tmp_path / f"p{suffix}")
    assert found.times.tolist() == times
    for frame in found.frames:
        check_same(frame, whole)


def test_a_class_of_a_large_number_needs_no_more_than_one_prototype(tmp_path):
    few = Instances(np.eye(3), classes=[7, 0, 2**31 - 1], ids=[3, 4, 5])
    usd.write(tmp_path / "p.usda", [few, few], times=[1, 2])
    found = usd.read(tmp_path / "p.usda")
    assert [name.rpartition("_")[2] for name in found.prototypes] == ["0", "7", "2147483647"]
    for frame in found.frames:
        check_same(frame, few)
    stage = Usd.Stage.Open(str(tmp_path / "p.usda"))
    prim = UsdGeom.PointInstancer(stage.GetPrimAtPath("/dapple/points"))
    assert list(prim.GetProtoIndicesAttr().Get()) == [1, 0, 2]


def test_a_prototype_of_a_file_with_wrong_faces_is_named(tmp_path, whole):
    stage = Usd.Stage.CreateNew(str(tmp_path / "wrong.usda"))
    stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, "/leaf").GetPrim())
    mesh = UsdGeom.Mesh.Define(stage, "/leaf/mesh")
    mesh.GetPointsAttr().Set([(0, 0, 0), (1, 0, 0), (0, 1, 0)])
    mesh.GetFaceVertexCountsAttr().Set([3])
    mesh.GetFaceVertexIndicesAttr().Set([0, 1, 7])
    stage.Save()
    for held in (False, True):
        wrong = Reference(tmp_path / "wrong.usda", held=held)
        with pytest.raises(ValueError, match=r"wrong\.usda: /leaf/mesh: .*7"):
            usd.write(tmp_path / "p.usda", whole, prototypes=[wrong] * 3)
    assert not (tmp_path / "p.usda").exists()
