# SPDX-License-Identifier: GPL-3.0-or-later
"""The same arguments give the same bytes today as yesterday; see docs/development/testing.md."""

import json
import re

import pytest
import same_bytes
from byte_cases import CASES, hashes_of

IN_TWO_THREADS = [
    "sample_wavy",
    "sample_soup",
    "classes_radii",
    "track_torus",
    "window_open",
    "population_grows",
    "resample_more",
    "stipple_color",
    "plane_torus_density",
    "mosaic",
    "remesh_box",
    "surface_spectrum",
]
SYSTEMS, RECORDED = same_bytes.read()


def check(name: str, threads: int) -> None:
    __tracebackhide__ = True
    found, entry = hashes_of(name, threads), RECORDED.get(name, {})
    words = same_bytes.difference(name, found, entry, SYSTEMS, same_bytes.system_name())
    if words:
        pytest.fail(words if threads == 1 else f"in {threads} threads {words}", pytrace=False)


@pytest.mark.parametrize("name", CASES)
def test_gives_the_same_bytes_as_ever(name):
    check(name, 1)


@pytest.mark.parametrize("name", IN_TWO_THREADS)
def test_gives_the_same_bytes_in_two_threads(name):
    check(name, 2)


def test_every_case_has_its_hashes():
    assert list(RECORDED) == list(CASES)


def test_every_case_has_hashes_of_its_own():
    """One that is equal to another would not notice an option that does nothing."""
    system = same_bytes.system_name()
    found = [json.dumps(same_bytes.expected(entry, system)) for entry in RECORDED.values()]
    assert len(set(found)) == len(found)


# --- the file of hashes

OLD, NEW = {"inputs": "1", "faces": "2"}, {"inputs": "1", "faces": "3"}
EVERY = same_bytes.EVERY


@pytest.mark.parametrize(
    ("entry", "systems", "written"),
    [
        ({}, [], {EVERY: NEW}),
        ({EVERY: OLD}, ["a"], {EVERY: NEW}),
        ({EVERY: OLD}, ["b"], {"a": NEW, "b": OLD}),
        ({EVERY: OLD}, ["a", "b", "c"], {"a": NEW, "b": OLD, "c": OLD}),
        ({EVERY: NEW}, ["b"], {EVERY: NEW}),
        ({"a": OLD, "b": NEW}, ["a", "b"], {EVERY: NEW}),
        ({"a": OLD, "b": OLD}, ["a", "b"], {"a": NEW, "b": OLD}),
        ({}, ["b"], {"a": NEW}),
        ({"a": NEW}, ["a", "b"], {"a": NEW}),
    ],
)
def test_writing_leaves_what_other_systems_have_written(entry, systems, written):
    assert same_bytes.merged(entry, NEW, systems, "a") == written


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        ({EVERY: NEW}, ""),
        ({"a": NEW, "b": OLD}, ""),
        ({}, "no hashes of it for a: .*--write"),
        ({"b": NEW}, "no hashes of it for a: .*--write"),
        ({EVERY: OLD}, "it gives different bytes on a: faces changed; .* from b, .*--write"),
        ({EVERY: {**NEW, "inputs": "4"}}, "it was computed from other inputs on a"),
        ({EVERY: {**NEW, "ids": "4"}}, "ids changed, not faces"),
        ({EVERY: {"inputs": "1"}}, "faces changed"),
    ],
)
def test_says_what_changed(entry, words):
    found = same_bytes.difference("it", NEW, entry, ["b"], "a")
    assert re.search(words, found) if words else not found


def test_reads_what_it_writes():
    cases = {"one": {EVERY: OLD}, "two": {"a": OLD, "b": NEW}}
    again = json.loads(same_bytes.text(["b", "a"], cases))
    assert again == {"systems": ["a", "b"], "cases": cases}
