#!/usr/bin/env python3
"""Breaks kernels on purpose and checks that `raymap devices --test` finds each fault.

Usage: scripts/break_kernels.py [--device vulkan:K] [--only TEXT]... [FOLDER]

Copies the tracked files to FOLDER (default: a temporary folder), builds the program there, and then for each
fault changes one place of a shader, builds again and runs the test. Prints a table: the fault, the check that
found it first, and its difference. Fails if the test passes without a fault being expected to hide, or if a
change no longer fits its shader. Takes some minutes, so it is not part of CI.
docs/dev/decisions/trust_before_use.md holds the last table.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
STAGES = "src/vulkan/stages/"
PRIMITIVES = "src/vulkan/primitives/"

# Fault, shader, its text, the text in its place, and the reason why this driver may hide the fault
# (empty: it may not).
FAULTS = [
    ("missing barrier before the sums of the subgroups are read", PRIMITIVES + "scan_blocks.comp",
     "  barrier();\n  if (gl_SubgroupID == 0) {", "  if (gl_SubgroupID == 0) {", ""),
    ("wrong subgroup size: 32 is assumed", "src/vulkan/device/subgroups.glsl",
     "gl_SubgroupID * gl_SubgroupSize +", "gl_SubgroupID * 32 +", ""),
    ("total of a subgroup read from lane 31", PRIMITIVES + "scan_blocks.comp",
     "gl_SubgroupInvocationID == gl_SubgroupSize - 1", "gl_SubgroupInvocationID == 31", ""),
    ("missing barrier between count and use of the bins", PRIMITIVES + "radix_sort_scatter.comp",
     "  barrier();\n  for (uint digit = laneIndex()", "  for (uint digit = laneIndex()", ""),
    ("rank of equal keys ignored", PRIMITIVES + "radix_sort_scatter.comp",
     "bins[bin] + before;", "bins[bin];", ""),
    ("rounding down instead of to the nearest", STAGES + "crossings.glsl",
     "(mantissa + (1l << (-shift - 1))) >> -shift", "mantissa >> -shift", ""),
    ("missing clamp to the band", STAGES + "finish.comp",
     "clamp(distance, -push.band, push.band)", "distance", ""),
    ("threshold counts as inside", STAGES + "sign.glsl",
     "inside = w > push.threshold;", "inside = w >= push.threshold;", ""),
    ("wrong constant: a fifth instead of a sixth", STAGES + "winding_harmonic_relax.comp",
     "(1.0 / 6.0)", "(1.0 / 5.0)", ""),
    ("one colour relaxed twice", STAGES + "winding_harmonic_relax.comp",
     "pairs), push.colour)", "pairs), 0)", ""),
    ("fractions of the squared distances ignored", STAGES + "distance_transform.comp",
     "uvec2(fractionOf(value), ", "uvec2(0, ", ""),
    ("missing barrier before the discs of the leaves", STAGES + "surface_tree_leaves.comp",
     "  barrier();\n  if (gl_LocalInvocationID.x >= kLeaves", "  if (gl_LocalInvocationID.x >= kLeaves", ""),
    ("radius of the discs too small", STAGES + "surface_tree_leaves.comp",
     "normal, radius, 0.5", "normal, 0.9 * radius, 0.5", ""),
    ("batch of a ray not carried on", STAGES + "ray_map_along.comp",
     "      sum += subgroupAdd(counts[i]);", "", ""),
    ("weight of the edges in the middle of a path", STAGES + "winding_paths.comp",
     "side == 0 || side == 3 ? 2 : 1", "side == 0 ? 2 : 1", ""),
    ("rows that floats leave open dropped", STAGES + "voxel_grid_exact.comp",
     "findRun(row, lane)", "ivec2(0, -1)", ""),
    ("places of crowded samples overlap", STAGES + "refine.comp",
     "atomicAdd(push.crowdedCount.at[0], 1)", "push.crowdedCount.at[0]++", ""),
    ("groups of each dispatch numbered from 0", STAGES + "refine_crowded.comp",
     "push.firstGroup + groupIndex()", "groupIndex()", ""),
    ("rows of groups numbered alike", "src/vulkan/device/kernel.glsl",
     "gl_WorkGroupID.y * gl_NumWorkGroups.x + ", "", ""),
    ("lines of more than 2,047 cells cut off", STAGES + "distance_transform.comp",
     "const uint length = lineLength();", "const uint length = min(lineLength(), 2047);", ""),
    ("cubes at the grid's border looked at", STAGES + "close_holes.comp",
     "any(equal(cube, ivec3(0))) || any(equal(cube, dims()))", "any(equal(cube, dims()))", ""),
    ("last joint of a vertex ignored", STAGES + "skin.comp",
     "pairs.y & 0xffffu, pairs.y >> 16", "pairs.y & 0xffffu, pairs.y & 0xffffu", ""),
    ("half floats rounded down", STAGES + "field_image_halves.comp",
     "(shifted + 0xfffu + (shifted >> 13 & 1u)) >> 13", "shifted >> 13", ""),
    ("walls of hollow shapes ignored", "src/picture/sphere_trace.glsl",
     "push.shape.wall > 0 ? max(d, -(d + push.shape.wall)) : d", "d", ""),
    ("one ray of a pixel taken twice", STAGES + "render_field.comp",
     "lights[local + 2] + lights[local + 3]", "lights[local + 2] + lights[local + 2]", ""),
    ("missing barrier after the count begins at zero", STAGES + "winding_rays.comp",
     "doubtfulOfGroup = 0;\n  barrier();", "doubtfulOfGroup = 0;",
     "the driver runs the first subgroup of a group first, up to the next barrier"),
    ("`precise` left out", PRIMITIVES + "float_pair.glsl",
     "  precise const float taken = total - a;\n  precise const float rest = (a - (total - taken)) + (b - taken);\n  FloatPair pair;",
     "  const float taken = total - a;\n  const float rest = (a - (total - taken)) + (b - taken);\n  FloatPair pair;",
     "the driver never joins a product and a sum to one operation"),
]


def run(command, **options):
    return subprocess.run(command, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, **options)


def copy_tree(folder):
    files = run(["git", "ls-files"], cwd=ROOT, check=True).stdout.split("\n")
    archive = subprocess.run(["tar", "-cf", "-", "--", *[f for f in files if (ROOT / f).is_file()]], cwd=ROOT,
                             stdout=subprocess.PIPE, check=True).stdout
    # -m: files of now, so that a folder that is used again is built again where its last fault was.
    subprocess.run(["tar", "-xmf", "-", "-C", str(folder)], input=archive, check=True)


def build(folder):
    result = run(["cmake", "--build", "build", "--target", "raymap_cli"], cwd=folder)
    if result.returncode != 0:
        sys.exit(result.stdout[-4000:] + "\nthe build failed")


def test(folder, device):
    """Returns the checks that failed, as pairs of name and difference."""
    with tempfile.TemporaryDirectory() as cache:
        result = subprocess.run([str(folder / "build/bin/raymap"), "devices", "--test", device, "--json"],
                                env=dict(os.environ, RAYMAP_CACHE=cache), stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True)
        if result.returncode not in (0, 9):
            mark = next((path.read_text() for path in Path(cache).glob("*.running")), "(none)")
            return [(mark, f"the process ended with code {result.returncode}")]
    found = json.loads(result.stdout)["tests"][0]
    failed = [(check["name"], check["difference"]) for check in found["checks"] if check["difference"]]
    if not failed and found["problem"]:
        failed = [tuple(found["problem"].split(": ", 1))]
    return failed


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", nargs="?")
    parser.add_argument("--device", default="vulkan")
    parser.add_argument("--only", action="append", help="faults or shaders that contain this text, or another")
    arguments = parser.parse_args()
    folder = Path(arguments.folder or tempfile.mkdtemp(prefix="raymap_broken_"))
    folder.mkdir(parents=True, exist_ok=True)
    copy_tree(folder)
    configured = run(["cmake", "-S", ".", "-B", "build", "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                      "-DRAYMAP_BUILD_TESTS=OFF",
                      "-DRAYMAP_OPENVDB=OFF", "-DRAYMAP_ASSIMP=OFF", "-DRAYMAP_VIEW=OFF"], cwd=folder)
    if configured.returncode != 0:
        sys.exit(configured.stdout)
    build(folder)
    if failed := test(folder, arguments.device):
        sys.exit(f"the test fails without any fault: {failed[0]}")
    print("| fault | kernel | first check that finds it | its difference |\n|---|---|---|---|", flush=True)
    missed = 0
    for what, file, old, new, reason in FAULTS:
        if arguments.only and not any(text in what + file for text in arguments.only):
            continue
        path = folder / file
        whole = path.read_text()
        if old not in whole:
            sys.exit(f"{file} does not contain '{old}': change {Path(__file__).name}")
        path.write_text(whole.replace(old, new))
        try:
            build(folder)
            failed = test(folder, arguments.device)
        finally:
            path.write_text(whole)
        check, difference = failed[0] if failed else ("none", reason or "NOT FOUND")
        missed += not failed and not reason
        more = f" and {len(failed) - 1} more" if len(failed) > 1 else ""
        difference = difference.replace("|", "\\|")
        print(f"| {what} | `{Path(file).name}` | {check}{more} | {difference} |", flush=True)
    sys.exit(f"{missed} faults were not found" if missed else 0)


if __name__ == "__main__":
    main()
