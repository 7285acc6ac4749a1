#!/usr/bin/env python3
"""Makes README's clip, docs/images/hero.webp: a broken duck, its field in slices, and its repair, before one camera.

hero_clip.py RAYMAP FOLDER: the program, and the folder of duck.obj (scripts/gallery_figures.py), which gets all frames.
Needs Pillow (scripts/python_env.sh)."""

import subprocess
import sys
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

SIZE, DEPTH = (800, 500), 0.86  # The duck reaches from -0.8 to 0.8 along z.
EYE = "2.4995,1.9954,3.57"  # Where `raymap info --picture` stands for this mesh and this size.
FONT = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"
TEXTS = ["A broken mesh: holes (red), reversed, crossing and doubled faces",
         "Its signed distance field in slices: blue is inside", "Its repair: one watertight solid"]  # fmt: skip


def run(raymap, folder, *command):
    subprocess.run([raymap, *map(str, command), "--quiet"], cwd=folder, check=True, stderr=subprocess.DEVNULL)


def render(raymap, folder, field, name, *options):
    run(raymap, folder, "render", field, "-o", name, "--size", *SIZE, "--eye", EYE, *options)
    return Image.open(folder / name).convert("RGB")


def labelled(picture, number):
    """Returns a picture with the text of its part, and round corners, for pages of any colour."""
    text, font = TEXTS[number], ImageFont.truetype(FONT, 21)
    draw = ImageDraw.Draw(picture := picture.copy(), "RGBA")
    draw.rounded_rectangle((14, SIZE[1] - 52, 38 + draw.textlength(text, font), SIZE[1] - 14), 19, (20, 24, 32, 215))
    draw.text((26, SIZE[1] - 33), text, "white", font, anchor="lm")
    ImageDraw.Draw(mask := Image.new("L", SIZE, 0)).rounded_rectangle((0, 0, SIZE[0] - 1, SIZE[1] - 1), 16, 255)
    picture.putalpha(mask)
    return picture


def main(raymap, folder):
    run(raymap, folder, "generate", "duck.obj", "-o", "hero.vdb", "--resolution", 256, "--close-holes", "--overwrite")
    run(raymap, folder, "repair", "duck.obj", "-o", "hero.obj", "--overwrite")
    run(raymap, folder, "generate", "hero.obj", "-o", "hero_solid.vdb", "--resolution", 256, "--overwrite")
    run(raymap, folder, "info", "duck.obj", "--picture", "hero.png", "--size", *SIZE, "--overwrite")
    frames, planes = [(Image.open(folder / "hero.png").convert("RGB"), 0, 1700)], [DEPTH * (1 - k / 12) for k in range(25)]
    for k, z in enumerate(planes):
        plane = f"0,0,1,{z:.4f}"
        frames.append((render(raymap, folder, "hero.vdb", f"hero_slice_{k}.png", "--cut-plane", plane, "--slice-plane", plane), 1, 90))
    for k, z in enumerate(reversed(planes[1:-2:2])):
        frames.append((render(raymap, folder, "hero_solid.vdb", f"hero_solid_{k}.png", "--cut-plane", f"0,0,1,{z:.4f}"), 2, 90))
    frames.append((render(raymap, folder, "hero_solid.vdb", "hero_solid.png"), 2, 2100))
    for part in (0, 1):  # The parts fade into one another.
        at = max(k for k, frame in enumerate(frames) if frame[1] == part)
        (old, *_), (new, *_) = frames[at : at + 2]
        frames[at + 1 : at + 1] = [(Image.blend(old, new, share), part + round(share), 60) for share in (0.25, 0.5, 0.75)]
    first, *others = (labelled(picture, part) for picture, part, _ in frames)
    target = Path(__file__).resolve().parent.parent / "docs/images/hero.webp"
    first.save(target, save_all=True, append_images=others, duration=[time for *_, time in frames], loop=0, quality=60, method=6,
               kmin=0, kmax=1)  # Whole frames: parts of frames leave traces.  # fmt: skip
    print(f"{target}: {target.stat().st_size} bytes, {sum(time for *_, time in frames) / 1000} s, {len(frames)} frames")


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve(), Path(sys.argv[2]))
