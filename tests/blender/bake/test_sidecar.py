# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of solved frames: what is stored, and which files are rejected."""

import shutil
from dataclasses import replace

import addon_host
import numpy as np
import pytest
from frame_files import rewritten


@pytest.fixture
def sidecar():
    return addon_host.part("core.bake.sidecar")


def solved(sidecar, count=5):
    records, keys = addon_host.part("core.surface.records"), addon_host.part("core.bake.keys")
    random = np.random.Generator(np.random.PCG64(2))
    faces = random.integers(0, len(FACES), count).astype(np.int32)
    binding = records.Binding(
        FACES[faces], random.dirichlet((1, 1, 1), count), random.normal(size=count)
    )
    report = addon_host.part("core.solve.solve").Report(count=count, spacing=0.25, converged=True)
    return sidecar.Solved(keys.Placed(faces, binding), report)


FACES = np.array([(0, 1, 2), (2, 1, 3), (2, 3, 4)], dtype=np.int32)


def triangles(faces=FACES):
    return addon_host.part("core.surface.arrays").SurfaceArrays(
        "Any", np.zeros((5, 3)), faces, "same"
    )


def test_a_frame_comes_back_as_it_was(sidecar, tmp_path):
    files, frame = sidecar.Sidecar(tmp_path / "ünfinished"), solved(sidecar)
    files.store(7, "abc", frame)
    found = files.load(7, "abc", 5, triangles())
    assert found.report == frame.report
    for name in ("corners", "barycentric", "angle"):
        there, here = getattr(found.placed.binding, name), getattr(frame.placed.binding, name)
        assert there.tobytes() == here.tobytes()
    assert [path.name for path in files.folder.iterdir()] == ["frame_000007.npz"]
    files.clear()
    assert not files.folder.exists()


def test_a_frame_of_other_input_is_not_taken(sidecar, tmp_path):
    files = sidecar.Sidecar(tmp_path)
    files.store(7, "abc", solved(sidecar))
    assert files.load(7, "abd", 5, triangles()) is None
    assert files.load(8, "abc", 5, triangles()) is None
    assert files.load(7, "abc", 4, triangles()) is None
    assert files.load(7, "abc", 5, triangles(FACES[:1])) is None


def test_a_file_torn_at_any_byte_is_not_taken(sidecar, tmp_path):
    files = sidecar.Sidecar(tmp_path)
    files.store(1, "abc", solved(sidecar))
    whole = files.path(1).read_bytes()
    for length in range(0, len(whole), 7):
        files.path(1).write_bytes(whole[:length])
        assert files.load(1, "abc", 5, triangles()) is None


def test_a_file_with_any_byte_turned_is_not_taken_as_other_values(sidecar, tmp_path):
    files, frame = sidecar.Sidecar(tmp_path), solved(sidecar)
    files.store(1, "abc", frame)
    whole = files.path(1).read_bytes()
    expected = frame.placed.binding
    for place in range(0, len(whole), 2):
        files.path(1).write_bytes(whole[:place] + bytes([whole[place] ^ 255]) + whole[place + 1 :])
        found = files.load(1, "abc", 5, triangles())
        if found is not None:  # some bytes, such as a date, do not matter
            assert (found.placed.binding.barycentric == expected.barycentric).all()
            assert (found.placed.binding.angle == expected.angle).all()


def test_a_file_of_another_frame_is_not_taken(sidecar, tmp_path):
    """All frames of a piece are solved from the same input."""
    files = sidecar.Sidecar(tmp_path)
    files.store(1, "abc", solved(sidecar))
    files.store(2, "abc", solved(sidecar), ahead=True)
    for path, other in ((1, {"frame": 2}), (1, {"frame": 1, "ahead": True})):
        shutil.copy(files.path(path), files.path(**other))
        assert (
            files.load(other["frame"], "abc", 5, triangles(), ahead=other.get("ahead", False))
            is None
        )
    shutil.copy(files.path(2, ahead=True), files.path(2))
    assert files.load(2, "abc", 5, triangles()) is None
    assert files.load(1, "abc", 5, triangles()) is not None


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("faces", lambda faces: (faces + 1) % len(FACES)),
        ("barycentric", lambda weights: weights[:, ::-1]),
        ("barycentric", lambda weights: weights * 2),
        ("angle", lambda angle: angle + 1e-9),
        ("settled", np.logical_not),
        ("report", lambda text: np.array(str(text).replace("0.25", "0.26"))),
    ],
)
def test_a_whole_file_of_other_values_is_not_taken(sidecar, tmp_path, name, change):
    files = sidecar.Sidecar(tmp_path)
    files.store(1, "abc", solved(sidecar))
    rewritten(files.path(1))
    assert files.load(1, "abc", 5, triangles()) is not None
    rewritten(files.path(1), **{name: change})
    assert files.load(1, "abc", 5, triangles()) is None


@pytest.mark.parametrize("foreign", [b"", b"hello", b"PK\x05\x06" + bytes(18)])
def test_a_foreign_file_is_not_taken(sidecar, tmp_path, foreign):
    files = sidecar.Sidecar(tmp_path)
    files.path(1).write_bytes(foreign)
    assert files.load(1, "abc", 5, triangles()) is None
    assert files.fingerprint(1) == ""


def test_a_pickle_is_never_opened(sidecar, tmp_path):
    class Bomb:
        def __reduce__(self):
            return (pytest.fail, ("a pickle was opened",))

    files = sidecar.Sidecar(tmp_path)
    np.savez(files.path(1), fingerprint=np.array([Bomb()], dtype=object))
    assert files.load(1, "abc", 5, triangles()) is None


def test_fingerprints_tell_inputs_apart(sidecar):
    surface, settings = (
        addon_host.part("core.surface.arrays"),
        addon_host.part("core.settings.values"),
    )
    start, ids = solved(sidecar).placed.binding, np.arange(5, dtype=np.int32)
    frame = surface.SurfaceArrays("Any", np.eye(3), FACES, "topology")

    def chain(frames, settings=settings.Settings(), start=start):  # noqa: B008
        digest = sidecar.Fingerprint(settings, start, (ids,))
        return [digest.add(each) for each in frames][-1]

    moved = replace(frame, vertices=np.eye(3) + 1e-7)
    found = [
        chain([frame]),
        chain([frame, frame]),
        chain([moved]),
        chain([moved, frame]),
        chain([frame, moved]),
        chain([replace(frame, topology="other")]),
        chain([frame], settings=settings.Settings(seed=1)),
        chain([frame], start=replace(start, angle=start.angle + 1e-9)),
    ]
    assert len(set(found)) == len(found)
    assert chain([frame]) == found[0]
