"""The table MESHES.tsv of a folder of meshes, and tables of what was measured on each of them."""

import csv
import pathlib
import subprocess
import tempfile


def mesh_rows(folder):
    """Returns the rows of the folder's table, by column."""
    with open(folder / "MESHES.tsv", newline="") as table:
        return list(csv.DictReader(table, delimiter="\t", quoting=csv.QUOTE_NONE))


def line(cells):
    return "| " + " | ".join(map(str, cells)) + " |"


def tabulate(path, titles, rows, measure, errors=()):
    """Prints and writes a table in markdown with a line for each mesh. `measure(row, folder)` returns its cells. If it fails,
    the line says why: with ValueError, with one of the further errors, or as a program did."""
    lines = [line(titles), "|" + "---|" * len(titles)]
    print(*lines, sep="\n", flush=True)
    for row in rows:
        try:
            with tempfile.TemporaryDirectory() as folder:
                cells = measure(row, pathlib.Path(folder))
        except (subprocess.CalledProcessError, ValueError, *errors) as error:
            said = (getattr(error, "stderr", None) or str(error)).strip().splitlines()[-1]
            cells = [row["file"], row["triangles"], "", said] + [""] * (len(titles) - 4)
        lines.append(line(cells))
        print(lines[-1], flush=True)
    path.write_text("\n".join(lines) + "\n")
