#!/usr/bin/env python3
"""Draws ten meshes of a folder before and after `raymap repair`, as one PNG.

Usage: bench/repair_pictures.py RAYMAP FOLDER PICTURE [--work FOLDER] [--resolution 256]

Before, `raymap info --picture` shows the triangles with their defects in colour. After, it shows those of the result, of
which none should be in colour; `raymap render` would show the field of the file instead. Results that
bench/evaluate_repair.py left in the work folder are drawn as they are, others are made. Needs Pillow."""
import argparse
import pathlib
import subprocess

from PIL import Image, ImageDraw

# A file, what is wrong with it, and further options of the picture.
MESHES = (
    ("draco__bun_zipper.ply", "scan with holes, seen from below", ("--direction", "-0.4", "0.9", "-0.6")),
    ("odedstein__demosthenes-low-res.obj", "bust, open below", ("--direction", "-0.5", "0.6", "-0.8")),
    ("common3d__teapot.obj", "open parts that cross", ()),
    ("meshlab__elephant.ply", "parts that cross, holes", ()),
    ("assimp__Wuson.stl", "loose sheets, crossing faces", ("--up", "0", "1", "0")),
    ("vtkdata__footbones.ply", "26 solids that overlap", ()),
    ("admesh__hourglass.stl", "turned faces", ()),
    ("meshlab__conrod.stl", "turned faces", ("--up", "0", "0", "1", "--direction", "-0.6", "1", "-0.7")),
    ("libigl__truck.obj", "open and turned parts", ()),
    ("trimesh__cycloidal.ply", "100 parts that cross", ()),
)
WIDTH, HEIGHT, TITLE = 360, 270, 18
COLUMNS = 2  # Pairs in a row.


def run(command):
    subprocess.run([str(word) for word in command], check=True, stdout=subprocess.DEVNULL)


def with_up(name, options):
    """Returns the options with the direction up of the mesh, which its result shares: STL alone has z up by default."""
    return options if "--up" in options else ("--up", "0", *(("0", "1") if name.lower().endswith(".stl") else ("1", "0")), *options)


def draw(raymap, mesh, picture, options):
    """Draws at twice the size, for smooth edges."""
    run([raymap, "info", mesh, "--picture", picture, "--size", 2 * WIDTH, 2 * HEIGHT, *options])
    return Image.open(picture).convert("RGB").resize((WIDTH, HEIGHT), Image.LANCZOS)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("raymap")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("picture", type=pathlib.Path)
    parser.add_argument("--resolution", type=int, default=256)
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("out/evaluation/repair"))
    arguments = parser.parse_args()
    arguments.work.mkdir(parents=True, exist_ok=True)
    arguments.picture.parent.mkdir(parents=True, exist_ok=True)
    rows = (len(MESHES) + COLUMNS - 1) // COLUMNS
    sheet = Image.new("RGB", (2 * COLUMNS * WIDTH, rows * (HEIGHT + TITLE)), "white")
    for place, (name, wrong, options) in enumerate(MESHES):
        result = arguments.work / (name + ".stl")
        if not result.exists():
            run([arguments.raymap, "repair", arguments.folder / name, "-o", result, "--resolution", arguments.resolution,
                 "--device", "cpu"])
        left, top = place % COLUMNS * 2 * WIDTH, place // COLUMNS * (HEIGHT + TITLE)
        ImageDraw.Draw(sheet).text((left + 4, top + 3), f"{name}: {wrong}", fill="black")
        for column, mesh in enumerate((arguments.folder / name, result)):
            picture = draw(arguments.raymap, mesh, arguments.work / "picture.png", with_up(name, options))
            sheet.paste(picture, (left + column * WIDTH, top + TITLE))
    sheet.save(arguments.picture, optimize=True)


if __name__ == "__main__":
    main()
