"""Warnings have a code and fields, and name the argument that helps."""

from __future__ import annotations

import inspect
import pickle
import re
import typing

import numpy as np
import pytest
import raymap
from raymap import _devices, _errors, _records


def box(low, high):
    """Vertices and faces of a box, its faces outwards."""
    vertices = np.array([[(low, high)[i >> axis & 1][axis] for axis in range(3)] for i in range(8)], float)
    faces = [(0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 2, 3), (0, 3, 1),
             (4, 5, 7), (4, 7, 6)]  # fmt: skip
    return vertices, np.array(faces)


def test_a_loss_names_the_voxel_size_that_keeps_it():
    (block, faces), (plate, _) = box((0, 0, 0), (10, 10, 10)), box((1, 4.03, 9), (9, 4.33, 16))
    with pytest.warns(raymap.RaymapWarning) as caught:
        report = raymap.repair(np.vstack([block, plate]), np.vstack([faces, faces + 8]), voxel_size=0.5, min_thickness=0, remesh=True,
                               device="cpu").report
    (warning,) = (each.message for each in caught)
    size = report["loss"]["voxel_size"]
    assert (warning.code, warning.fields["voxel_size"]) == ("solid_lost", size)
    assert warning.fields["share"] == report["loss"]["solid_share"] + report["loss"]["open_share"] > 0
    assert f"a voxel size of {size:g} keeps them" in str(warning)
    assert str(warning).endswith(f"plates keep what is thin (voxel_size={size:g})")
    (told,) = report["warnings"]
    assert told["code"] == "solid_lost" and str(warning) == f"{told['message']} (voxel_size={size:g})"


def test_rounding_says_how_far_vertices_move(ball):
    with pytest.warns(raymap.RaymapWarning) as caught:
        raymap.Mesh(ball.vertices + (5e6, 4e6, 100), ball.faces).save("far.stl")
    warning = caught[0].message
    assert warning.code == "rounding" and warning.fields["file"] == "far.stl"
    assert 0 < warning.fields["length"] < 0.5 and "--" not in str(warning)
    assert f"by up to {warning.fields['length']:.3g}" in str(warning)


def test_an_orientation_that_fits_nothing_is_told(large_ball):
    fan = np.array(large_ball.faces)
    fan[:, 2] = len(large_ball.vertices)  # All faces meet in the centre.
    turned = np.random.default_rng(5).random(len(fan)) < 0.5
    fan[turned] = fan[turned][:, [1, 0, 2]]
    with pytest.warns(raymap.RaymapWarning) as caught:
        field = raymap.generate(np.vstack([large_ball.vertices, [(0, 0, 0)]]), fan, resolution=40, device="cpu")
    warning = caught[0].message
    assert warning.code == "orientation_misfit" and not field.stats["orientation_fits"]
    assert warning.fields["share"] == field.stats["misfit"]
    assert str(warning).endswith("and mend it (raymap.info)")


def test_a_field_without_an_inside_names_what_helps():
    plate = raymap.Mesh(*box((-1, -1, 0.04), (1, 1, 0.06)))
    bounds = ((-1.2, -1.2, -0.25), (1.2, 1.2, 0.25))
    with pytest.warns(raymap.RaymapWarning, match=r"use a spacing of 0\.0098 \(voxel_size=0\.0098\)$") as caught:
        field = raymap.generate(plate, voxel_size=0.1, bounds=bounds, device="cpu")
    assert caught[0].message.code == "nothing_inside" and not (field.distance < 0).any()
    assert (raymap.generate(plate, voxel_size=0.0098, device="cpu").distance < 0).any()
    sheet = raymap.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    with pytest.warns(raymap.RaymapWarning, match=r" \(thickness=0\.2\)$") as caught:
        raymap.generate(sheet, voxel_size=0.1, device="cpu")
    assert caught[0].message.fields["length"] == 0.2
    assert (raymap.generate(sheet, voxel_size=0.1, thickness=0.2, device="cpu").distance < 0).any()


def test_a_refused_gpu_names_the_function_that_tests_it(monkeypatch):
    monkeypatch.setattr("raymap._raymap.device_to_test", lambda: "vulkan:99")
    with pytest.warns(raymap.RaymapWarning, match=r"\(raymap.test_device\('vulkan:99'\)\)$") as caught:
        assert _devices.tested("auto") == "cpu"
    assert (caught[0].message.code, caught[0].message.fields) == ("device_refused", {"device": "vulkan:99"})


def test_remedies_belong_to_codes_and_name_arguments():
    arguments = inspect.signature(raymap.repair).parameters
    assert set(_errors._REMEDIES) <= set(typing.get_args(_records.WarningCode))
    for code, remedy in _errors._REMEDIES.items():
        name = re.match(r"(?:raymap\.)?(\w+)", remedy)[1]
        assert hasattr(raymap, name) if remedy.startswith("raymap.") else name in arguments, code
    assert _errors.worded("solid_lost", "lost", {"voxel_size": 0.0}) == "lost"


def test_warnings_survive_pickle():
    warning = pickle.loads(pickle.dumps(raymap.RaymapWarning("text", "rounding", {"length": 1.0})))
    assert (str(warning), warning.code, warning.fields) == ("text", "rounding", {"length": 1.0})
