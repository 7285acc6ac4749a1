"""Making fields: options, equality with the command line, threads, Ctrl-C, progress, errors."""

from __future__ import annotations

import inspect
import multiprocessing
import os
import pickle
import signal
import threading
from pathlib import Path

import numpy as np
import pytest
import raymap
from helpers import interrupted, right_in_threads


def generate(mesh, **options):
    return raymap.generate(mesh, **{"resolution": 24, "device": "cpu", **options})


def test_the_docstring_says_negative_inside_first():
    assert "negative inside" in raymap.generate.__doc__.splitlines()[0]


def test_defaults_are_those_of_the_command_line(ball, run_raymap):
    ball.save("mesh.ply")
    run_raymap("generate", "mesh.ply", "-o", "field.npz", "--device", "cpu")
    expected = raymap.load_field("field.npz")
    field = raymap.generate(ball, device="cpu")
    np.testing.assert_array_equal(field.distance, expected.distance)
    np.testing.assert_array_equal(field.origin, expected.origin)
    assert field.spacing == expected.spacing


@pytest.mark.parametrize("options, arguments", [
    (dict(resolution=20), ["--resolution", "20"]),
    (dict(voxel_size=0.17), ["--voxel-size", "0.17"]),
    (dict(voxel_size=0.17, align=True), ["--voxel-size", "0.17", "--align"]),
    (dict(padding=0.3), ["--padding", "0.3"]),
    (dict(bounds=((-1, -2, -1.5), (1, 1, 2))), ["--bounds", "-1", "-2", "-1.5", "1", "1", "2"]),
    (dict(distance="cell"), ["--distance", "cell"]),
    (dict(distance="raster"), ["--distance", "raster"]),
    (dict(sign="paths"), ["--sign", "paths"]),
    (dict(sign="none"), ["--sign", "none"]),
    (dict(orientation="keep"), ["--orientation", "keep"]),
    (dict(orientation="repair"), ["--orientation", "repair"]),
    (dict(close_holes=True), ["--close-holes"]),
    (dict(thickness=0.5), ["--thickness", "0.5"]),
    (dict(band=2.5), ["--band", "2.5"]),
])
def test_options_are_those_of_the_command_line(ball, run_raymap, options, arguments):
    broken = raymap.Mesh(ball.vertices, np.concatenate([ball.faces[40:200, ::-1], ball.faces[260:]]))
    broken.save("mesh.ply")
    size = [] if {"resolution", "voxel_size"} & options.keys() else ["--resolution", "24"]
    run_raymap("generate", "mesh.ply", "-o", "field.npz", "--device", "cpu", *size, *arguments)
    expected = raymap.load_field("field.npz")
    field = generate(broken, **options)
    np.testing.assert_array_equal(field.distance, expected.distance)
    np.testing.assert_array_equal(field.origin, expected.origin)
    assert (field.spacing, field.clamp_distance) == (expected.spacing, expected.clamp_distance)


def test_arrays_are_those_of_the_command_line(ball, run_raymap):
    ball.save("mesh.ply")
    names = dict(winding="winding", confidence="confidence", triangle="triangle-ids")
    files = [f for name, option in names.items() for f in (f"--{option}", f"{name}.nrrd")]
    run_raymap("generate", "mesh.ply", "-o", "f.nrrd", "--device", "cpu", "--resolution", 24, *files)
    field = generate(ball, arrays=list(names))
    for name in names:
        np.testing.assert_array_equal(getattr(field, name), getattr(raymap.load_field(f"{name}.nrrd"), name))
    assert generate(ball, arrays="winding").arrays == ("distance", "winding")
    assert generate(ball, arrays=()).arrays == ("distance",)


def test_any_form_of_a_mesh_gives_the_same_bits(ball, files):
    expected = generate(ball).distance
    loaded = raymap.load_mesh(files / "ball.ply")
    for form in (str(files / "ball.ply"), files / "ball.ply", loaded, pickle.loads(pickle.dumps(loaded))):
        np.testing.assert_array_equal(generate(form).distance, expected)
    arrays = raymap.generate(loaded.vertices, loaded.faces, resolution=24, device="cpu")
    np.testing.assert_array_equal(arrays.distance, expected)


def test_any_number_of_threads_gives_the_same_bits(ball):
    expected = generate(ball, threads=1, arrays=("winding", "confidence"))
    for threads in (2, 3, None):
        field = generate(ball, threads=threads, arrays=("winding", "confidence"))
        for name in field.arrays:
            np.testing.assert_array_equal(getattr(field, name), getattr(expected, name))


def test_stats(ball):
    flipped = raymap.Mesh(ball.vertices, np.concatenate([ball.faces[:40, ::-1], ball.faces[40:]]))
    stats = generate(flipped, orientation="repair").stats
    assert stats["device"] == "cpu"
    assert [stage["name"] for stage in stats["stages"]][1] == "exact_distance"
    assert stats["milliseconds"] >= sum(stage["milliseconds"] for stage in stats["stages"]) * 0.999
    assert stats["bytes"] > 24**3 * 4
    assert stats["turned_faces"].dtype == np.uint32
    np.testing.assert_array_equal(stats["turned_faces"], np.arange(40))
    assert stats["misfit_given"] > stats["misfit"] and stats["orientation_fits"]
    assert stats["doubtful_share"] > 0
    holed = raymap.Mesh(ball.vertices, ball.faces[40:])
    stats = generate(holed, close_holes=True).stats
    assert stats["patch_triangles"] > 0 and stats["patch_area"] > 0


@pytest.mark.parametrize("options, error, text", [
    (dict(distance="near"), raymap.UsageError, "'near'; use exact, neighbours, cell or raster"),
    (dict(sign="left"), raymap.UsageError, "'left'; use harmonic"),
    (dict(orientation="up"), raymap.UsageError, "'up'; use auto, keep or repair"),
    (dict(device="abacus"), raymap.UsageError, "abacus"),
    (dict(device="vulkan:99"), raymap.UnsupportedError, None),
    (dict(resolution=0), raymap.UsageError, None),
    (dict(resolution=-3), raymap.UsageError, None),
    (dict(voxel_size=0), raymap.UsageError, "voxel_size must be above 0, not 0"),
    (dict(voxel_size=float("nan")), raymap.UsageError, "voxel_size must be above 0, not nan"),
    (dict(padding=-1), raymap.UsageError, None),
    (dict(shape=(4, 4, 4), align=True), raymap.UsageError, "align says where samples lie, as shape and cube do"),
    (dict(bounds=(0, 0, 0, 1, 1, 1)), raymap.UsageError, r"bounds must be \(\(x0"),
    (dict(bounds=((0, 0, 0), (1, 0, 1))), raymap.UsageError, "less than"),
    (dict(bounds=((0, 0, 0), (1, float("nan"), 1))), raymap.UsageError, "finite"),
    (dict(band=-1), raymap.UsageError, "band"),
    (dict(thickness=0), raymap.UsageError, "thickness must be above 0, not 0"),
    (dict(thickness=1, sign="paths"), raymap.UsageError, "thickness takes the place of sign"),
    (dict(thickness=1, arrays="winding"), raymap.UsageError, "winding and confidence need a sign"),
    (dict(sign="none", arrays=["confidence"]), raymap.UsageError, "winding and confidence need a sign"),
    (dict(sign="none", close_holes=True), raymap.UsageError, None),
    (dict(distance="raster", arrays=["triangle"]), raymap.UsageError, None),
    (dict(arrays=["colour"]), raymap.UsageError, "nothing is named 'colour'"),
    (dict(threads=-1), raymap.UsageError, "threads"),
    (dict(memory_limit=0), raymap.UsageError, "memory_limit must be 1 or more, not 0"),
    (dict(memory_limit=1000), raymap.MemoryLimitError, "the field needs"),
    (dict(memory_limit=1000), MemoryError, "the field needs"),
    (dict(threads=1.5), TypeError, None),
    (dict(resolution="many"), TypeError, None),
    (dict(progress=3), TypeError, "progress must be a callable"),
])
def test_arguments_that_make_no_sense(ball, options, error, text):
    with pytest.raises(error, match=text):
        generate(ball, **options)


def test_an_empty_mesh_is_far_on_request(ball):
    vertices, faces = np.empty((0, 3)), np.empty((0, 3), np.int64)
    box = dict(bounds=((0, 0, 0), (2, 1, 1)), resolution=8, allow_empty=True)
    field = raymap.generate(vertices, faces, **box, arrays=("winding", "confidence", "triangle"))
    assert field.shape == (8, 4, 4) and field.surface_bounds is None
    assert (field.distance == np.finfo(np.float32).max).all() and (field.winding == 0).all()
    assert (field.confidence == 1).all() and (field.triangle == raymap.NO_TRIANGLE).all()
    assert (raymap.generate(vertices, faces, **box, band=3, invert=True).distance == -0.75).all()
    Path("empty.obj").write_text("v 0 0 0\n")
    from_file = raymap.generate("empty.obj", **box)
    np.testing.assert_array_equal(from_file.distance, field.distance)
    np.testing.assert_array_equal(from_file.sample([(1, 0.5, 0.5)]), [np.finfo(np.float32).max])
    assert len(raymap.load_mesh("empty.obj", allow_empty=True).faces) == 0
    with pytest.raises(raymap.InputError, match="empty.obj: the mesh has no faces; with allow_empty=True"):
        raymap.generate("empty.obj", bounds=box["bounds"])
    with pytest.raises(raymap.InputError, match="^the mesh has no faces; with allow_empty=True"):
        raymap.generate(vertices, faces, bounds=box["bounds"])
    with pytest.raises(raymap.UsageError, match="empty.obj: the mesh has no faces, so it has no bounds; give bounds"):
        raymap.generate("empty.obj", allow_empty=True)
    with pytest.raises(raymap.InputError, match="no triangles"):
        raymap.load_mesh("empty.obj")
    generator = raymap.Generator()
    assert (generator.generate(ball, **box).distance < 0).any()
    assert (generator.generate(vertices, faces, **box).distance > 1).all()


def test_meshes_that_are_not_valid():
    corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0.0)])
    with pytest.raises(raymap.InputError, match="3"):
        generate(raymap.Mesh(corners, [(0, 1, 3)]))
    with pytest.raises(ValueError):
        generate(raymap.Mesh(corners, np.empty((0, 3), int)))
    corners[1, 2] = np.nan
    with pytest.raises(raymap.InputError, match="1"):
        generate(raymap.Mesh(corners, [(0, 1, 2)]))
    for call in (raymap.info, raymap.repair, raymap.Generator().generate):
        with pytest.raises(raymap.InputError):
            call(raymap.Mesh(corners, [(0, 1, 2)]))
    with pytest.raises(raymap.InputError):
        raymap.Mesh(corners, [(0, 1, 2)]).bounds


def test_errors_are_of_the_classes_of_python():
    assert issubclass(raymap.UsageError, ValueError) and issubclass(raymap.InputError, ValueError)
    assert issubclass(raymap.FileError, OSError) and issubclass(raymap.MemoryLimitError, MemoryError)
    for name in ("UsageError", "InputError", "FileError", "MemoryLimitError", "Cancelled", "UnsupportedError",
                 "DeviceLostError"):
        assert issubclass(getattr(raymap, name), raymap.Error)
        assert getattr(raymap, name).__module__ == "raymap"
    with pytest.raises(raymap.FileError, match="gone.ply"):
        raymap.generate("gone.ply")
    with pytest.raises(raymap.Error) as caught:
        raymap.load_mesh(os.fsdecode(b"gone\xff.ply"))
    assert "gone" in str(caught.value)


def test_generator_equals_the_function(ball):
    generator = raymap.Generator()
    for size, resolution in ((1.0, 24), (3.0, 12), (0.5, 24)):
        mesh = raymap.Mesh(ball.vertices * size, ball.faces)
        field = generator.generate(mesh, resolution=resolution, arrays=("winding",), device="cpu")
        np.testing.assert_array_equal(field.distance, generate(mesh, resolution=resolution).distance)
        np.testing.assert_array_equal(field.winding, generate(mesh, resolution=resolution, arrays="winding").winding)
    with pytest.raises(TypeError, match="resolutoin"):
        generator.generate(ball, resolutoin=3)
    named = inspect.signature(raymap.generate).parameters
    options = {n for n, p in named.items() if p.kind is p.KEYWORD_ONLY}
    assert set(raymap.FieldOptions.__annotations__) == options - {"sparse"}  # It decides the type of the result.


def test_fields_of_a_generator_stay_as_they_are(ball):
    generator = raymap.Generator()
    fields, copies = [], []
    for k in range(5):
        mesh = raymap.Mesh(ball.vertices * (1 + k), ball.faces)
        fields.append(generator.generate(mesh, resolution=12, device="cpu").distance)
        copies.append(fields[-1].copy())
    for view, copy in zip(fields, copies):
        np.testing.assert_array_equal(view, copy)


def test_a_generator_uses_memory_again(ball):
    generator = raymap.Generator()
    places = set()
    for _ in range(6):
        field = generator.generate(ball, resolution=12, device="cpu")
        places.add(field.distance.ctypes.data)
    assert len(places) == 2
    with pytest.raises(raymap.UsageError):
        generator.generate(ball, band=-1, device="cpu")
    np.testing.assert_array_equal(field.distance, generate(ball, resolution=12).distance)


def test_threads_of_python_may_share_everything(ball):
    generator = raymap.Generator()
    expected = [generate(ball, resolution=8 + k).distance for k in range(4)]

    def is_right(k: int) -> bool:
        makers = (generator.generate, raymap.generate)
        return all((make(ball, resolution=8 + k, device="cpu").distance == expected[k]).all() for make in makers)

    assert right_in_threads(is_right)


def test_other_threads_run_meanwhile(held):
    """The work waits for another thread, which can only run if the work does not keep the GIL."""
    giver = threading.Thread(target=held.give)
    giver.start()
    assert len(raymap.load_mesh(held.path).faces) == 1280
    giver.join()


def test_ctrl_c_is_heard_while_work_runs(held):
    """The work waits until the signal has been handled."""
    handled = threading.Event()

    def handle(*_: object) -> None:
        handled.set()
        raise KeyboardInterrupt

    def interrupt() -> None:
        held.wait_for_reader()
        signal.pthread_kill(threading.main_thread().ident, signal.SIGINT)
        handled.wait()
        held.give()

    before = signal.signal(signal.SIGINT, handle)
    interrupter = threading.Thread(target=interrupt)
    interrupter.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            raymap.load_mesh(held.path)
    finally:
        signal.signal(signal.SIGINT, before)
    interrupter.join()


def test_processes_may_be_forked(ball):
    expected = generate(ball)
    with multiprocessing.get_context("fork").Pool(2) as pool:
        for field in pool.map(generate, [ball] * 4):
            np.testing.assert_array_equal(field.distance, expected.distance)


def test_progress_names_every_stage(ball):
    reports = []
    field = generate(ball, progress=lambda stage, done: reports.append((stage, done)))
    assert list(dict.fromkeys(stage for stage, _ in reports)) == [stage["name"] for stage in field.stats["stages"]]
    assert all(0 <= done <= 1 for _, done in reports)
    for call in (raymap.info, lambda m, progress: raymap.repair(m, resolution=16, progress=progress),
                 lambda m, progress: field.to_mesh(progress=progress)):
        reports.clear()
        call(ball, progress=lambda stage, done: reports.append((stage, done)))
        assert reports


def test_progress_that_returns_false_cancels(ball):
    with pytest.raises(raymap.Cancelled, match="cancelled during"):
        generate(ball, progress=lambda stage, done: False)


def test_progress_that_raises_cancels(ball):
    calls = []

    def fail(stage: str, done: float) -> None:
        calls.append(stage)
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        generate(ball, progress=fail)
    assert len(calls) == 1


@pytest.mark.parametrize("call", ["field", "generator", "info", "repair", "isosurface"])
def test_ctrl_c_stops_the_work(ball, call):
    generator, field = raymap.Generator(), generate(ball)
    with interrupted() as progress:
        options = dict(resolution=24, device="cpu", progress=progress)
        if call == "field":
            raymap.generate(ball, **options)
        elif call == "generator":
            generator.generate(ball, **options)
        elif call == "info":
            raymap.info(ball, progress=progress)
        elif call == "repair":
            raymap.repair(ball, **options)
        else:
            field.to_mesh(progress=progress)
    assert generator.generate(ball, resolution=8, device="cpu").shape == (8, 8, 8)


def test_warnings_name_the_line_of_the_caller():
    Path("odd.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\ncurv2 1 2\n")
    with pytest.warns(raymap.RaymapWarning) as caught:
        raymap.load_mesh("odd.obj")
    assert caught[0].filename == __file__ and "odd.obj" in str(caught[0].message)


def test_a_gpu_makes_nearly_the_same_field(large_ball):
    found = [d["id"] for d in raymap.devices() if d["id"] != "cpu" and not d["problem"]]
    if not found:
        assert not os.environ.get("RAYMAP_REQUIRE_VULKAN")
        pytest.skip("there is no Vulkan device")
    stages = []
    field = generate(large_ball, device=found[0], arrays=("winding",), progress=lambda *report: stages.append(report))
    expected = generate(large_ball, arrays=("winding",))
    assert field.stats["device"] == found[0] and stages
    np.testing.assert_allclose(field.distance, expected.distance, atol=1e-5)
    np.testing.assert_allclose(field.winding, expected.winding, atol=1e-3)
    picture = expected.render(width=64, height=48, device=found[0])
    assert picture.shape == (48, 64, 3)


def test_devices():
    found = raymap.devices()
    assert found[0]["id"] == "cpu" and found[0]["type"] == "cpu" and found[0]["memory"] > 0
    assert sum(device["chosen_by_auto"] for device in found) == 1
    with pytest.raises(raymap.UsageError):
        raymap.test_device("cpu")


def test_options_of_the_sign_are_those_of_the_command_line(ball, run_raymap):
    """On an open mesh, where each option changes the winding number or the sign."""
    raymap.Mesh(ball.vertices, ball.faces[:-300]).save("open.ply")
    with open("offsets.txt", "w") as file:
        file.write("3 1 -2\n-4 0 1\n0 5 2\n")
    common = {"resolution": 20, "device": "cpu", "arrays": ("distance", "winding")}
    for line, sign, options in (
        ("--sign paths --passes 2", "paths", {"passes": 2}),
        ("--sign evolution --sampling paper", "evolution", {"sampling": "paper"}),
        ("--sign paths --offsets offsets.txt", "paths", {"offsets": [(3, 1, -2), (-4, 0, 1), (0, 5, 2)]}),
        ("--threshold 0.8", "harmonic", {"threshold": 0.8}),
        ("--invert", "harmonic", {"invert": True}),
    ):
        files = ("open.ply", "-o", "cli.npz", "--winding", "w.npy")
        run_raymap("generate", *files, "--resolution", 20, "--device", "cpu", *line.split())
        expected = raymap.load_field("cli.npz")
        made, plain = (raymap.generate("open.ply", sign=sign, **common, **given) for given in (options, {}))
        np.testing.assert_array_equal(made.distance, expected.distance)
        np.testing.assert_array_equal(made.winding, expected.winding)
        assert (made.distance != plain.distance).any() or (made.winding != plain.winding).any()
    plain = raymap.generate(ball, resolution=20, device="cpu").distance
    np.testing.assert_array_equal(raymap.Surface(ball).generate(resolution=20, device="cpu", invert=True).distance, -plain)


@pytest.mark.parametrize("options, text", [
    (dict(sign="paths", offsets=[(1, 2)]), r"offsets must be \(n, 3\) whole numbers"),
    (dict(sign="paths", offsets=[(0.5, 1, 2)]), "whole numbers, not float64"),
    (dict(sign="paths", offsets=[(2**31, 1, 2)]), "of 32 bits"),
    (dict(sign="paths", passes=-1), "passes must be 1 or more"),
    (dict(sampling="raster"), "there is no sampling 'raster'"),
    (dict(threshold=-1), "threshold"),
])
def test_options_of_the_sign_that_make_no_sense(ball, options, text):
    with pytest.raises(raymap.UsageError, match=text):
        raymap.generate(ball, resolution=8, device="cpu", **options)
