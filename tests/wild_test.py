#!/usr/bin/env python3
"""Gives the checks of scripts/wild.py results with planted faults, which they must find. Needs the Python package."""

import importlib.util
import os
import signal
import sys
import types
import unittest
import unittest.mock
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
spec = importlib.util.spec_from_file_location("wild", ROOT / "scripts/wild.py")
wild = importlib.util.module_from_spec(spec)
spec.loader.exec_module(wild)
from broken import torus  # noqa: E402
from harness import positions  # noqa: E402


def exact_field(mesh, grid):
    where = np.ascontiguousarray(positions(grid))
    distance = wild.exact_distance(mesh, where)
    return np.where(wild.exact_winding(mesh, where) > 0.5, -distance, distance)


def endless():
    while True:
        pass


def faults(judged):
    return wild.faults("repairs", {"state": "ok", **judged})


class Wild(unittest.TestCase):
    def setUp(self):
        self.mesh = wild.wild_meshes.rounded(torus(24, 12)[0]), torus(24, 12)[1]
        wild.Case.closed = {("torus", False): self.mesh}
        self.case = wild.Case("torus", "holes", 1)

    def judged(self, faces, said=0.0):
        return wild.judge_repair(self.case, self.mesh[0], faces, said)

    def test_accepts_the_closed_mesh(self):
        judged = self.judged(self.mesh[1])
        self.assertEqual(faults(judged), [])
        self.assertEqual((judged["kept"], judged["lost"]), (1, 0))
        self.assertLess(judged["volume"], 1e-12)

    def test_finds_a_missing_face(self):
        self.assertEqual(faults(self.judged(self.mesh[1][1:]))[0], "not watertight")

    def test_finds_a_turned_face(self):
        faces = self.mesh[1].copy()
        faces[5] = faces[5][::-1]
        self.assertEqual(faults(self.judged(faces)), ["not watertight"])

    def test_finds_a_repeated_face(self):
        self.assertEqual(faults(self.judged(np.concatenate([self.mesh[1], self.mesh[1][:1]]))), ["not watertight"])

    def test_finds_an_empty_result(self):
        self.assertEqual(faults(self.judged(self.mesh[1][:0])), ["empty"])

    def test_finds_lost_area_unless_it_is_said(self):
        half = self.mesh[1][: len(self.mesh[1]) // 2]
        lost = self.judged(half)["lost"]
        self.assertTrue(0.3 < lost < 0.6)
        self.assertTrue(any("unsaid" in text for text in faults(self.judged(half))))
        self.assertFalse(any("unsaid" in text for text in faults(self.judged(half, said=lost))))

    def test_a_face_that_moved_is_not_kept(self):
        moved = self.mesh[0].copy()
        moved[self.mesh[1][0, 0]] *= 1 + 1e-6
        whole = wild.judge_repair(self.case, *self.mesh, 0.0)["kept"]
        self.assertLess(wild.judge_repair(self.case, moved, self.mesh[1], 0.0)["kept"], whole)

    def test_finds_wrong_signs_and_errors(self):
        case = wild.Case("torus", "unbroken", 1)
        wild.prepare_field(case, 16)

        def run(vertices, faces, grid):
            return exact_field((vertices, faces), grid)

        right = wild.measure_field(case, run, 16)
        self.assertEqual((right["wrong"], right["near"], right["max"]), (0, 0, 0))
        wrong = wild.measure_field(case, lambda *given: 0.1 - run(*given), 16)
        self.assertGreater(wrong["near"], 0.9)
        self.assertGreater(wrong["max"], 0.01)
        self.assertEqual(len(wild.faults("fields", {"state": "ok", **wrong}, 0.1)), 1)

    def test_the_check_fails_at_a_fault(self):
        options = types.SimpleNamespace(seeds=[1], repairs=5, resolution=12, out=None, jobs=1, meshes=None)
        closed = self.mesh

        def peers(faces, shift):
            def field(vertices, faces, grid):
                return shift + exact_field(closed, grid)

            return lambda kind: {"raymap": lambda: field if kind == "fields" else lambda *broken: (closed[0], faces, 1.0)}

        with unittest.mock.patch.object(wild.wild_meshes, "closed_meshes", lambda only: {"torus": closed}):
            for faces, shift, least in (closed[1], 0, 0), (closed[1][1:], 0, 4), (closed[1], 0.5, 10):
                with unittest.mock.patch.object(wild.wild_peers, "peers", peers(faces, shift)):
                    found = wild.quick(options)
                    self.assertTrue(found >= least if least else found == 0, found)

    def test_says_how_a_process_ends(self):
        self.assertEqual(wild.isolated(lambda: 5), ("ok", 5))
        self.assertEqual(wild.isolated(lambda: 1 / 0)[0], "refused")
        self.assertEqual(wild.isolated(lambda: os.kill(os.getpid(), signal.SIGSEGV)), ("crash", "signal 11"))
        self.assertEqual(wild.isolated(endless, 1)[0], "hang")

    def test_breaks_are_those_of_the_seed(self):
        mesh, hollow = wild.wild_meshes.with_cavity(self.mesh)
        for way in wild.wild_meshes.WAYS:
            first, again, other = (wild.wild_meshes.broken(mesh, way, seed, hollow) for seed in (1, 1, 2))
            for a, b in zip(first, again, strict=True):
                self.assertTrue(np.array_equal(a, b), way)
            self.assertFalse(all(np.array_equal(a, b) for a, b in zip(first, other, strict=True)), way)


if __name__ == "__main__":
    sys.exit(unittest.main())
