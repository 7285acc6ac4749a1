#!/usr/bin/env python3
"""Runs the lessons of docs/tutorials, each in an empty folder: all blocks of `sh` and `python`, in their order.

tutorials.py [--write] [LESSON...]: a block of `text` is what the block before it prints. A picture of docs/images/tutorials
is what the lesson draws under that name. Both must be so, but --write puts them so. Needs the release build with the Python
package (scripts/test.sh makes it)."""

import contextlib
import io
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PICTURES = ROOT / "docs/images/tutorials"
BLOCK = re.compile(r"^```(sh|python)\n(.*?)^```\n(\n```text\n(.*?)^```\n)?", re.MULTILINE | re.DOTALL)
LONGEST, LARGEST, FARTHEST = 60, 60_000, 4  # Lines, bytes of a picture, and its mean difference of 255.


def run_block(kind, code, names):
    if kind == "sh":
        done = subprocess.run(["bash", "-euc", code], capture_output=True, text=True, check=False)
        if done.returncode:
            raise RuntimeError(done.stdout + done.stderr)
        return done.stdout
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        exec(compile(code, "block", "exec"), names)  # noqa: S102
    return printed.getvalue()


def difference(old, new):
    """Returns the mean difference of two pictures, of 255; of pictures of different size, 255."""
    import matplotlib.pyplot as plt
    import numpy as np

    a, b = (plt.imread(path)[..., :3] * 255 for path in (old, new))
    return float(np.abs(a - b).mean()) if a.shape == b.shape else 255


def check_pictures(text, write):
    for name in re.findall(r"\(\.\./images/tutorials/(\S+\.png)\)", text):
        drawn, kept = Path(name), PICTURES / name
        if not drawn.exists():
            yield f"does not draw {name}"
        elif drawn.stat().st_size > LARGEST:
            yield f"draws {name} of {drawn.stat().st_size} bytes; at most {LARGEST}"
        elif write:
            PICTURES.mkdir(exist_ok=True)
            kept.write_bytes(drawn.read_bytes())
        elif not kept.exists() or difference(kept, drawn) > FARTHEST:
            yield f"draws another {name} than docs/images/tutorials has"


def run_lesson(path, write):
    """Yields the faults of a lesson. The current folder is its own."""
    text, names, faults = path.read_text(), {"__name__": "lesson"}, []

    def run(block):
        kind, code, answer, expected = block.groups()
        printed = run_block(kind, code, names).rstrip() + "\n" if answer else run_block(kind, code, names)
        if answer and printed != expected and not write:
            faults.append(f"prints\n{printed}instead of\n{expected}")
        return f"```{kind}\n{code}```\n" + (f"\n```text\n{printed}```\n" if answer else "")

    written = BLOCK.sub(run, text)
    lines = sum(bool(line.strip()) for line in text.splitlines())
    if lines > LONGEST:
        faults.append(f"has {lines} lines; at most {LONGEST}")
    if write:
        path.write_text(written)
    return faults + list(check_pictures(text, write))


def main():
    write = "--write" in sys.argv
    named = [Path(name).resolve() for name in sys.argv[1:] if not name.startswith("--")]
    lessons = named or sorted((ROOT / "docs/tutorials").glob("*.md"))
    if "--here" in sys.argv:  # In a process and a folder of its own.
        sys.exit("\n".join(f"{lessons[0].name} {fault}" for fault in run_lesson(lessons[0], write)) or 0)
    python = subprocess.run([ROOT / "scripts/python_env.sh"], capture_output=True, text=True, check=True).stdout.strip()
    release = ROOT / "build/release"
    environment = {**os.environ, "PATH": f"{release / 'bin'}:{Path(python).parent}:{os.environ['PATH']}", "MPLBACKEND": "agg",
                   "PYTHONPATH": f"{release / 'python'}", "RAYMAP_CACHE": "off"}
    failed = []
    for lesson in lessons:
        with tempfile.TemporaryDirectory() as folder:
            flags = ["--here", *(["--write"] if write else [])]
            done = subprocess.run([python, __file__, *flags, lesson], cwd=folder, env=environment, check=False)
        if done.returncode:
            failed.append(lesson.name)
    print(f"{len(lessons)} lessons, failed: {', '.join(failed) or 'none'}")
    sys.exit(bool(failed))


if __name__ == "__main__":
    main()
