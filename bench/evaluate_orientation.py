"""Measures how often signs are wrong where faces point the wrong way, or both ways, ours beside the peers'.

The results are the section "Turned faces" of docs/evaluation.md (SET flipped), and "Double-sided faces" of
docs/signs.md (SET doubled).

    evaluate_orientation.py ORIENTATION_CASES SET FOLDER OUT

ORIENTATION_CASES is the program, FOLDER holds meshes, OUT gets tables: SET.md, mesh by mesh, and SET_summary.md. A sample is inside
- for ours and libigl's fast winding number, if |w| > 1/2;
- for Open3D, if most of 11 rays leave through an odd number of faces;
- for OpenVDB's meshToVolume, if its distance is negative.
"""

import argparse
import json
import pathlib
import subprocess
import tempfile

import igl
import numpy as np
import open3d

import peers

METHODS = {"keep": "`keep`", "auto": "`auto`", "repair": "`repair`", "libigl": "libigl", "open3d": "Open3D",
           "openvdb": "OpenVDB"}  # fmt: skip


def is_inside_libigl(vertices, triangles, samples):
    return np.abs(igl.fast_winding_number(vertices, triangles, samples)) > 0.5


def is_inside_open3d(vertices, triangles, samples):
    scene = open3d.t.geometry.RaycastingScene()
    scene.add_triangles(open3d.core.Tensor(vertices.astype(np.float32)), open3d.core.Tensor(triangles.astype(np.uint32)))
    return scene.compute_occupancy(open3d.core.Tensor(samples.astype(np.float32)), nsamples=11).numpy() > 0.5


def add_peers(case):
    """Adds results of the peers that the program does not run itself, on the mesh that it left."""
    vertices, triangles = peers.read_mesh(case["name"])
    truth = np.fromfile(case["name"] + ".inside", np.uint8) != 0
    samples = peers.sample_positions(case, "float64")[:: case["stride"]]
    case["share_inside"] = 100 * truth.mean()
    for name, is_inside in (("libigl", is_inside_libigl), ("open3d", is_inside_open3d)):
        case[name] = {"wrong": 100 * np.mean(is_inside(vertices, triangles, samples) != truth)}


def run_cases(program, cases_set, folder):
    with tempfile.TemporaryDirectory() as work:
        with subprocess.Popen([program, cases_set, folder, work], stdout=subprocess.PIPE, text=True) as cases:
            for line in cases.stdout:
                case = json.loads(line)
                add_peers(case)
                for file in pathlib.Path(work).glob(pathlib.Path(case["name"]).name + ".*"):
                    file.unlink()
                yield case
        if cases.returncode != 0:
            raise SystemExit(f"{program} failed")


def titles():
    return "| mesh | breakage | flipped | inside | " + " | ".join(METHODS.values()) + (
        " | of the inside found by OpenVDB | misfit before, after | `auto`'s CPU time / `keep`'s |\n" + "|---" * (7 + len(METHODS)) + "|")


def row(case):
    wrong = [f"{case[method]['wrong']:.3f} %" for method in METHODS]
    chosen = case["auto"]
    cells = [case["mesh"], case["broken"], f"{100 * case['flipped']:.0f} %", f"{case['share_inside']:.1f} %", *wrong,
             f"{case['openvdb']['found']:.0f} %", f"{chosen['misfit_given']:.4f}, {chosen['misfit']:.4f}",
             f"{chosen['cpu'] / case['keep']['cpu']:.1f}"]
    return "| " + " | ".join(cells) + " |"


def summary(cases):
    """Returns, for every way to break a mesh, the mean and the worst of all meshes."""
    kinds = {}
    for case in cases:
        kinds.setdefault((case["broken"], case["flipped"]), []).append(case)
    lines = ["| the mesh | flipped | " + " | ".join(METHODS.values()) + " | OpenVDB finds the inside | CPU time |",
             "|---" * (4 + len(METHODS)) + "|"]
    for (broken, flipped), rows in kinds.items():
        cells = []
        for method in METHODS:
            wrong = [case[method]["wrong"] for case in rows]
            cells.append(f"{np.mean(wrong):.3f}, {max(wrong):.3f}")
        cells.append(f"{sum(case['openvdb']['found'] > 50 for case in rows)} of {len(rows)}")
        cells.append(f"{max(case['auto']['cpu'] / case['keep']['cpu'] for case in rows):.1f}")
        lines.append(f"| {broken} | {100 * flipped:.0f} % | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("set", choices=("flipped", "doubled"))
    parser.add_argument("folder")
    parser.add_argument("out", type=pathlib.Path)
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    cases = []
    with open(args.out / f"{args.set}.md", "w") as table:
        print(titles(), file=table)
        for case in run_cases(args.program, args.set, args.folder):
            print(row(case), file=table, flush=True)
            cases.append(case)
    (args.out / f"{args.set}_summary.md").write_text(summary(cases) + "\n")
    print(summary(cases))


if __name__ == "__main__":
    main()
