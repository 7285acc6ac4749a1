#!/usr/bin/env python3
"""Runs the pages of docs/tutorials, or others, each in an empty folder: all blocks of `sh` and `python`, in their order.

tutorials.py [--write] [PAGE...]: a block prints what a block of `text` behind it says, where `...` is anything, or else
nothing. A picture of docs/images/tutorials is what the page draws under that name. Both must be so, but --write puts them
so. A block of another language whose first line names a file in a comment is written there. Needs the release build with
the Python package (scripts/test.sh makes it), or that of the program that RAYMAP_BINARY names. Lessons (docs/teach) are run
by python/tests/test_docs.py, with an installed library."""

import contextlib
import doctest
import io
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PICTURES = ROOT / "docs/images/tutorials"
BLOCK = re.compile(r"^```(?!text)(\w+)\n(.*?)^```\n(\n?```text\n)?(?:(?<=text\n)(.*?)^(?=```\n))?", re.MULTILINE | re.DOTALL)
LONGEST, LARGEST, FARTHEST = 65, 60_000, 4  # Lines, bytes of a picture, and its mean difference of 255.


def run_block(kind, code, names):
    """Returns what a block prints, in a shell also on stderr."""
    if kind == "sh":
        done = subprocess.run(["bash", "-euc", code], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        if done.returncode:
            raise RuntimeError(f"{code}ends with {done.returncode}:\n{done.stdout}")
        return done.stdout
    if kind == "python":
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            exec(compile(code, "block", "exec"), names)  # noqa: S102
        return printed.getvalue()
    if file := re.match(r"(?:#|//) (\S+\.\w+)\n", code):
        Path(file[1]).write_text(code)
    return ""


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


def run_page(path, write):
    """Yields the faults of a page. The current folder is its own."""
    text, names, faults = path.read_text(), {"__name__": "lesson"}, []

    def run(block):
        kind, code, answer, expected = block.groups()
        printed = "".join(line.rstrip() + "\n" for line in run_block(kind, code, names).splitlines())
        if doctest.OutputChecker().check_output(expected or "", printed, doctest.ELLIPSIS):
            return block[0]
        if not (write and answer):
            faults.append(f"{code}prints\n{printed}and not\n{expected or ''}")
        return f"```{kind}\n{code}```\n{answer}{printed}" if answer else block[0]

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
        sys.exit("\n".join(f"{lessons[0].name} {fault}" for fault in run_page(lessons[0], write)) or 0)
    python = subprocess.run([ROOT / "scripts/python_env.sh"], capture_output=True, text=True, check=True).stdout.strip()
    release = Path(os.environ.get("RAYMAP_BINARY", ROOT / "build/release/bin/raymap")).parents[1]
    environment = {**os.environ, "PATH": f"{release / 'bin'}:{Path(python).parent}:{os.environ['PATH']}", "MPLBACKEND": "agg",
                   "PYTHONPATH": f"{release / 'python'}", "RAYMAP_CACHE": "off"}
    failed = []
    for lesson in lessons:
        with tempfile.TemporaryDirectory() as folder:
            flags = ["--here", *(["--write"] if write else [])]
            done = subprocess.run([python, __file__, *flags, lesson], cwd=folder, env=environment, check=False)
        if done.returncode:
            failed.append(lesson.name)
    print(f"{len(lessons)} pages, failed: {', '.join(failed) or 'none'}")
    sys.exit(bool(failed))


if __name__ == "__main__":
    main()
