# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes of Godot: a parser of their text finds all instances in place, and the meshes."""

import json
import re
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

import dapple3d as dapple
import numpy as np
import pytest
from dapple3d import instances
from dapple3d.extras import _gltf_files, gltf, godot
from dapple3d.instances import Instances, Mesh, Reference, Scatter

TRIANGLE = Mesh(np.array([[0.0, 0, 0], [1, 0, 0], [0, 0, 2]]), np.array([[0, 1, 2]]))
HEADING = re.compile(r'\[([a-z_]+)((?: [a-z_]+=(?:"(?:[^"\\]|\\.)*"|\d+))*)\]')
KEY = re.compile(r' ([a-z_]+)=("(?:[^"\\]|\\.)*"|\d+)')
VALUE = re.compile(r"([a-z_]+(?:/[a-z_]+)?) = (.+)")


@dataclass
class Section:
    """A heading with the lines below it."""

    kind: str
    keys: dict[str, str | int]
    values: dict[str, str]


def sections_of(path: Path) -> list[Section]:
    """All sections, by the grammar of Godot's text files; anything else fails."""
    found: list[Section] = []
    for line in filter(None, path.read_text(encoding="utf-8").splitlines()):
        if heading := HEADING.fullmatch(line):
            keys = {key: json.loads(value) for key, value in KEY.findall(heading[2])}
            found.append(Section(heading[1], keys, {}))
            continue
        value = VALUE.fullmatch(line)
        assert value, line
        found[-1].values[value[1]] = value[2]
    return found


def numbers(text: str, kind: str) -> np.ndarray:
    assert text.startswith(f"{kind}(")
    assert text.endswith(")")
    dtype = {"PackedFloat32Array": np.float32, "PackedInt64Array": np.int64}[kind]
    return np.array(text[len(kind) + 1 : -1].split(","), dtype)


def resource_of(sections: list[Section], text: str) -> Section:
    """The section that a value refers to; it is above."""
    kind, name = re.fullmatch(r'(Sub|Ext)Resource\("(\w+)"\)', text).groups()
    kind = {"Sub": "sub_resource", "Ext": "ext_resource"}[kind]
    (found,) = (one for one in sections if one.kind == kind and one.keys["id"] == name)
    return found


@dataclass
class Placed:
    """A MultiMeshInstance3D: matrices of Godot's space (n, 4, 4)."""

    path: str
    matrices: np.ndarray
    ids: np.ndarray | None
    mesh: Section


def placed_in(path: Path) -> list[Placed]:
    """All instances of a scene, which is checked as a whole."""
    sections = sections_of(path)
    head = sections[0]
    resources = [one for one in sections if one.kind in ("ext_resource", "sub_resource")]
    assert (head.kind, head.keys["format"]) == ("gd_scene", 3)
    assert head.keys["load_steps"] == len(resources) + 1
    order = ["gd_scene", "ext_resource", "sub_resource", "node"]
    kinds = [order.index(one.kind) for one in sections]
    assert kinds == sorted(kinds)
    assert len({(one.kind, one.keys["id"]) for one in resources}) == len(resources)
    found, known = [], {"."}
    nodes = [one for one in sections if one.kind == "node"]
    assert nodes[0].keys == {"name": "dapple", "type": "Node3D"}
    for node in nodes[1:]:
        parent, name = node.keys["parent"], node.keys["name"]
        assert parent in known
        place = name if parent == "." else f"{parent}/{name}"
        assert place not in known
        known.add(place)
        if node.keys["type"] == "MultiMeshInstance3D":
            found.append(_placed(sections, node, place))
    return found


def _placed(sections: list[Section], node: Section, place: str) -> Placed:
    multi = resource_of(sections, node.values["multimesh"])
    assert multi.keys["type"] == "MultiMesh"
    assert multi.values["transform_format"] == "1"
    names = list(multi.values)  # Godot sets them in this order
    assert names.index("transform_format") < names.index("instance_count") < names.index("buffer")
    rows = numbers(multi.values["buffer"], "PackedFloat32Array").reshape(-1, 3, 4)
    assert len(rows) == int(multi.values["instance_count"])
    matrices = np.tile(np.eye(4), (len(rows), 1, 1))
    matrices[:, :3] = rows
    ids = node.values.get("metadata/ids")
    return Placed(
        place,
        matrices,
        None if ids is None else numbers(ids, "PackedInt64Array"),
        resource_of(sections, multi.values["mesh"]),
    )


TURN = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])  # z up to y up


def expected(found: Instances, up: str = "Z", factor: float = 1.0) -> np.ndarray:
    """Matrices of Godot's space."""
    w, x, y, z = found.orientations.T
    matrices = np.tile(np.eye(4), (len(found), 1, 1))
    matrices[:, 0, :3] = np.stack(
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], 1
    )
    matrices[:, 1, :3] = np.stack(
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)], 1
    )
    matrices[:, 2, :3] = np.stack(
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], 1
    )
    matrices[:, :3, :3] *= found.scales[:, None, :]
    matrices[:, :3, 3] = found.positions * factor
    return TURN @ matrices @ TURN.T if up == "Z" else matrices


@pytest.fixture
def whole() -> Instances:
    random = np.random.default_rng(0)
    return Instances(
        random.normal(size=(50, 3)),
        instances.orientations(random.normal(size=(50, 3))),
        random.uniform(0.5, 2, (50, 3)) * random.choice([-1, 1], (50, 3)),
        ids=2**40 + np.arange(50),
        classes=np.arange(50) % 3,
    )


@pytest.mark.parametrize("up", ["Y", "Z"])
@pytest.mark.parametrize("factor", [1.0, 0.01])
def test_every_instance_is_in_place(tmp_path, whole, up, factor):
    path = tmp_path / "points.tscn"
    godot.write(path, whole, up=up, meters_per_unit=factor)
    found = placed_in(path)
    assert [one.path for one in found] == [f"points/points_{k}" for k in range(3)]
    matrices = expected(whole, up, factor)
    for k, one in enumerate(found):
        here = whole.classes == k
        np.testing.assert_array_equal(one.ids, whole.ids[here])
        np.testing.assert_allclose(one.matrices, matrices[here], rtol=1e-6, atol=1e-7)


def test_points_are_where_gltf_has_them(tmp_path, surface):
    found = instances.of_samples(dapple.sample(surface, 30, max_evaluations=2))
    godot.write(tmp_path / "a.tscn", found)
    gltf.write(tmp_path / "a.glb", found)
    document = _gltf_files.load(tmp_path / "a.glb")
    (node,) = (one for one in document.tree["nodes"] if "extensions" in one)
    (one,) = placed_in(tmp_path / "a.tscn")
    np.testing.assert_allclose(
        one.matrices, gltf.instance_matrices(document, node), rtol=1e-6, atol=1e-7
    )


def test_numbers_are_those_of_32_bits(tmp_path):
    places = np.array([[1e-30, 0.1, 1e30], [-0.0, 1 / 3, -12345678.9]])
    godot.write(tmp_path / "a.tscn", Instances(places), up="Y")
    (one,) = placed_in(tmp_path / "a.tscn")
    np.testing.assert_array_equal(one.matrices[:, :3, 3], places.astype(np.float32))
    assert "-0.0" not in (tmp_path / "a.tscn").read_text()
    assert one.ids is None


def test_balls_have_the_size_of_those_of_gltf(tmp_path, whole):
    godot.write(tmp_path / "a.tscn", whole, meters_per_unit=0.5)
    for one in placed_in(tmp_path / "a.tscn"):
        assert one.mesh.keys["type"] == "SphereMesh"
        radius = Scatter("a", [whole]).radius * 0.5
        assert float(one.mesh.values["radius"]) == pytest.approx(radius, rel=1e-6)
        assert float(one.mesh.values["height"]) == pytest.approx(2 * radius, rel=1e-6)


def test_meshes_are_files_beside_the_scene(tmp_path, whole):
    path = tmp_path / "trees.tscn"
    shapes = [
        TRIANGLE,
        Reference(tmp_path / "models" / "fern.obj"),
        Reference('res://a/b "c".tres'),
    ]
    godot.write(path, whole, prototypes=shapes, meters_per_unit=2)
    paths = [one.mesh.keys["path"] for one in placed_in(path)]
    assert paths == ["trees_meshes/points_0.obj", "models/fern.obj", 'res://a/b "c".tres']
    assert sorted(one.name for one in tmp_path.rglob("*")) == [
        *("points_0.obj", "trees.tscn", "trees_meshes"),
    ]
    mesh = dapple.read_mesh(tmp_path / paths[0])
    np.testing.assert_array_equal(mesh.vertices, [[0, 0, 0], [2, 0, 0], [0, 4, 0]])
    assert mesh.faces.tolist() == [[0, 1, 2]]


def test_a_file_that_stands_twice_is_named_once(tmp_path, whole):
    fern = Reference(Path("../fern.mesh"))
    godot.write(tmp_path / "a.tscn", whole, prototypes=[fern] * 3)
    kinds = [one.kind for one in sections_of(tmp_path / "a.tscn")]
    assert kinds.count("ext_resource") == 1
    assert len(placed_in(tmp_path / "a.tscn")) == 3


def test_several_scatters_have_a_node_each(tmp_path, whole):
    two = [Scatter("grass", [whole]), Scatter("rocks", [whole], [TRIANGLE] * 3)]
    godot.write_scatters(tmp_path / "a.tscn", two)
    found = placed_in(tmp_path / "a.tscn")
    assert [one.path.partition("/")[0] for one in found] == ["grass"] * 3 + ["rocks"] * 3
    assert len(list((tmp_path / "a_meshes").iterdir())) == 3


def test_no_instances_are_no_nodes(tmp_path):
    godot.write(tmp_path / "a.tscn", Instances(np.empty((0, 3))))
    assert placed_in(tmp_path / "a.tscn") == []


def test_the_same_instances_are_the_same_bytes(tmp_path, whole):
    for name in "ab":
        godot.write(tmp_path / f"{name}.tscn", whole)
    assert (tmp_path / "a.tscn").read_bytes() == (tmp_path / "b.tscn").read_bytes()


LOADING = """extends SceneTree
func _initialize():
	var scene = load("res://trees.tscn").instantiate()
	for node in scene.find_children("*", "MultiMeshInstance3D", true, false):
		var multi = node.multimesh
		var height = multi.mesh.get_aabb().size.y
		var found = [multi.instance_count, Array(node.get_meta("ids")), height]
		print("FOUND ", JSON.stringify(found))
	scene.free()
	quit()
"""


@pytest.mark.skipif(not shutil.which("godot"), reason="Godot is not installed")
def test_godot_loads_meshes_and_ids(tmp_path, whole):
    """Its matrices are on the graphics card, which it does without here."""
    godot.write(tmp_path / "trees.tscn", whole, prototypes=[TRIANGLE] * 3)
    (tmp_path / "project.godot").write_text("config_version=5\n")
    (tmp_path / "check.gd").write_text(LOADING)
    call = ["godot", "--headless", "--path", str(tmp_path)]
    subprocess.run([*call, "--import"], check=True, capture_output=True, timeout=120)
    said = subprocess.run(
        [*call, "-s", "res://check.gd"], check=True, capture_output=True, text=True, timeout=120
    ).stdout
    found = [json.loads(line[6:]) for line in said.splitlines() if line.startswith("FOUND ")]
    assert found == [
        [int((whole.classes == k).sum()), whole.ids[whole.classes == k].tolist(), 2.0]
        for k in range(3)
    ]


ONE = Instances(np.ones((1, 3)))
HUGE = Instances(np.array([[0.0, 0, 0], [1e39, 0, 0]]))
STRETCHED = Instances(np.ones((1, 3)), scales=np.full((1, 3), 1e39))


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"name": "a.tscx"}, r"a\.tscx: a scene of Godot ends with \.tscn"),
        ({"up": "X"}, "up is 'X': Y or Z is needed"),
        ({"meters_per_unit": np.nan}, "meters_per_unit is nan: a number > 0"),
        ({"found": HUGE}, r"positions\[1\] is no 32-bit float: \[1e\+39, 0\.0, 0\.0\]"),
        ({"found": STRETCHED}, r"scales\[0\] is no 32-bit float"),
        ({"prototypes": [Reference("fern.glb")]}, r"fern\.glb: Godot loads meshes from \.obj, "),
        ({"prototypes": [Reference("a.obj", "Fern")]}, r"a\.obj: is one mesh, so it has no 'Fern'"),
        ({"prototypes": [Reference("\udcff.obj")]}, "obj': a scene of Godot is Unicode"),
        (
            {"prototypes": [Mesh(1e39 * np.eye(3), [[0, 1, 2]])]},
            r"vertices\[0\] is no 32-bit float",
        ),
        ({"node": 'a"]\n[node'}, "name is .*: letters, digits and _ are needed"),
        ({"node": ""}, "name is '': letters, digits"),
    ],
)
def test_what_cannot_be_written_is_refused(tmp_path, given, said):
    arguments = {"name": "a.tscn", "found": ONE, "node": "points"} | given
    path, found, node = (arguments.pop(name) for name in ("name", "found", "node"))
    with pytest.raises(ValueError, match=said):
        godot.write(tmp_path / path, found, name=node, **arguments)
    assert [one for one in tmp_path.rglob("*") if one.is_file()] == []


def test_scatters_that_do_not_fit_are_refused(tmp_path, whole):
    with pytest.raises(ValueError, match="name is 'a', which another scatter has too"):
        godot.write_scatters(tmp_path / "a.tscn", [Scatter("a", [whole])] * 2)
    with pytest.raises(ValueError, match="walk has 2 frames: a scene of Godot holds one"):
        godot.write_scatters(tmp_path / "a.tscn", [Scatter("walk", [whole] * 2)])


def test_a_folder_that_cannot_be_made_is_named(tmp_path, whole):
    (tmp_path / "a_meshes").write_text("in the way")
    with pytest.raises(OSError, match="a_meshes"):
        godot.write(tmp_path / "a.tscn", whole, prototypes=[TRIANGLE] * 3)
    assert not (tmp_path / "a.tscn").exists()
