# SPDX-License-Identifier: GPL-3.0-or-later
"""`dapple relax` and `dapple resample`: as the functions of the library, from files."""

import json

import dapple3d as dapple
import numpy as np
import pytest
from checks import is_on_density
from command_line import done, refused, run
from dapple3d.cli import points
from shapes import torus


@pytest.fixture
def files(tmp_path):
    """A mesh with densities, and 300 points on it."""
    vertices, faces = torus(60, 30)
    sides = (vertices[faces][:, :, 0].mean(axis=1) > 0).astype(float)
    mesh, path = tmp_path / "torus.npz", tmp_path / "points.npz"
    np.savez(mesh, vertices=vertices, faces=faces, half=sides, plain=np.ones(len(faces)))
    done("sample", mesh, path, "-n", 300)
    return mesh, path


def loaded(mesh, density=None):
    with np.load(mesh) as arrays:
        values = None if density is None else arrays[density]
        at = {} if values is None else {"density_at": "faces"}
        return dapple.Surface(arrays["vertices"], arrays["faces"], density=values, **at)


def expect_same(path, samples):
    found = points.read_points(path)
    for name in points.OF_SAMPLES:
        np.testing.assert_array_equal(getattr(found, name), getattr(samples, name))


def test_resamples_as_the_library_does(files, tmp_path):
    mesh, source = files
    surface, out = loaded(mesh), tmp_path / "out.npz"
    old = points.bound(surface, source)
    said = done("resample", mesh, source, out, "-n", 350).stdout
    assert said.startswith(f"{out}: 350 points of 300, alpha min ")
    expect_same(out, dapple.resample(surface, old, 350))
    locked = [*range(20), 250]
    report = tmp_path / "report.json"
    done("resample", mesh, source, out, "-n", 260, "--locked", "250,0-19", "--json", report)
    expect_same(out, dapple.resample(surface, old, 260, locked=locked))
    told = json.loads(report.read_text())
    assert told["settings"]["locked"] == 21
    assert told["report"]["count"] == told["settings"]["count"] == 260


def test_resamples_for_another_density_or_spacing(files, tmp_path):
    mesh, source = files
    out = tmp_path / "out.npz"
    done("resample", mesh, source, out, "-n", 300, "--density", "half")
    surface = loaded(mesh, "half")
    assert is_on_density(surface, points.bound(surface, out)).all()
    spacing = surface.spacing(500)
    done("resample", mesh, source, out, "--spacing", spacing)
    assert len(points.read_points(out).positions) == loaded(mesh).count(spacing)


def test_refuses_to_resample_several_classes(files, tmp_path):
    mesh, source, out = files[0], tmp_path / "plants.npz", tmp_path / "out.npz"
    done("classes", mesh, source, "--class", 30, "--class", 70)
    said = refused("resample", mesh, source, out, "-n", 200)
    assert f"{source}: holds points of 2 classes, and resample knows one" in said
    assert not out.exists()


def test_resampled_points_keep_their_class(files):
    surface = loaded(files[0])
    found = dapple.sample(surface, 100)
    own = dapple.Samples(surface, found.faces, found.barycentric, classes=np.full(100, 3))
    assert set(dapple.resample(surface, own, 120).classes) == {3}


def test_relaxes_as_the_library_does(files, tmp_path):
    mesh, source = files
    out, report = tmp_path / "out.npz", tmp_path / "report.json"
    after = loaded(mesh, "half")
    before = after.with_density(np.load(mesh)["plain"], density_at="faces")
    old = points.bound(after, source)
    arguments = ("relax", mesh, source, out, "--density", "half", "--density-before", "plain")
    done(*arguments, "--json", report)
    where = dapple.changed_faces(before, after)
    empty = np.flatnonzero(np.load(mesh)["half"] == 0)
    np.testing.assert_array_equal(where, empty)
    expect_same(out, dapple.relax(after, old, where))
    told = json.loads(report.read_text())
    assert told["changed_faces"] == len(where)
    np.save(tmp_path / "faces.npy", np.load(mesh)["half"] == 0)
    named = ("relax", mesh, source, out, "--density", "half", "--changed", tmp_path / "faces.npy")
    done(*named, "-n", 300, "--locked", "3-5")
    expect_same(out, dapple.relax(after, old, where, count=300, locked=[3, 4, 5]))


def test_relaxes_classes_as_the_library_does(files, tmp_path):
    mesh, source = files[0], tmp_path / "plants.npz"
    done("classes", mesh, source, "--class", "30:radius=0.1", "--class", 270)
    out, after = tmp_path / "out.npz", loaded(mesh, "half")
    old = points.bound(after, source)
    arguments = ("relax", mesh, source, out, "--density", "half", "--density-before", "plain")
    done(*arguments, "--class", "20:radius=0.1", "--class", 200)
    where = np.flatnonzero(np.load(mesh)["half"] == 0)
    classes = [dapple.SampleClass(20, radius=0.1), dapple.SampleClass(200)]
    expect_same(out, dapple.relax(after, old, where, classes=classes))
    assert np.bincount(points.read_points(out).classes).tolist() == [20, 200]
    like = done("relax", mesh, source, out, "--changed", "0", "--class", "30", "--class", 270)
    assert "faces changed\n  class 0: 30 points, " in like.stdout  # the whole is not measured
    assert f"{source}: holds points of 2 classes: give --class for each" in refused(*arguments)


def test_relaxes_where_vertices_have_moved(files, tmp_path):
    mesh, source = files
    vertices, faces = np.load(mesh)["vertices"], np.load(mesh)["faces"]
    moved = vertices.copy()
    moved[:200] *= 1.2
    dented, out = tmp_path / "dented.npz", tmp_path / "out.npz"
    np.savez(dented, vertices=moved, faces=faces)
    done("relax", dented, source, out, "--before", mesh)
    now = loaded(dented)
    then = now.deformed(vertices)
    old = points.bound(then, source)
    old = dapple.Samples(now, old.faces, old.barycentric, ids=old.ids)
    expect_same(out, dapple.relax(now, old, dapple.changed_faces(then, now)))


@pytest.mark.parametrize(
    ("given", "code", "said"),
    [
        (("resample",), 2, "Missing option '-n' / '--count', or '--spacing'"),
        (("resample", "-n", 9, "--locked", "5-"), 2, "'5-': a number or a range such as 0-99"),
        (("resample", "-n", 9, "--locked", "5-3"), 2, "'5-3' ends before it begins"),
        (("resample", "-n", 9, "--locked", "3,300"), 1, "entry 1 is 300: there are 300 points"),
        (("resample", "-n", 9, "--locked", "0-20"), 1, "locked"),
        (("relax",), 2, "give either --changed, or --before and --density-before"),
        (("relax", "--changed", "3600"), 1, "--changed: entry 0 is 3600: there are 3600 faces"),
        (("relax", "--changed", "0", "--density-before", "half"), 2, "give either --changed"),
        (("relax", "--changed", "0-9", "--locked", "999"), 1, "--locked: entry 0 is 999"),
        (("relax", "--density-before", "none"), 1, "none"),
    ],
)
def test_names_what_does_not_fit(files, tmp_path, given, code, said):
    mesh, source = files
    name, *rest = given
    out = tmp_path / "out.npz"
    found = run(name, mesh, source, out, *rest)
    assert (found.exit_code, found.stdout) == (code, "")
    assert said in " ".join(found.stderr.split())
    assert not out.exists()


def test_refuses_a_mesh_of_other_faces_and_files_of_no_numbers(files, tmp_path):
    mesh, source = files
    other, out = tmp_path / "other.npz", tmp_path / "out.npz"
    vertices, faces = torus(20, 10)
    np.savez(other, vertices=vertices, faces=faces)
    said = refused("relax", mesh, source, out, "--before", other)
    assert f"{other}: its faces are not those of {mesh}" in said
    for values, wrong in (
        (np.zeros(3, bool), "one for each of 300 points"),
        (np.zeros(3), "whole numbers"),
        (np.array([0, -1]), "entry 1 is -1"),
    ):
        np.save(tmp_path / "locked.npy", values)
        given = ("-n", 310, "--locked", tmp_path / "locked.npy")
        assert wrong in refused("resample", mesh, source, out, *given)
    refused("resample", mesh, source, mesh, "-n", 310)
