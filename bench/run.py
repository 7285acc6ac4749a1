#!/usr/bin/env python3
"""Measures Raymap, and prints a table of docs/performance.md, docs/evaluation.md or others.

run.py TABLE --help says what a table has and takes. scripts/bench.sh builds what the tables need and calls this.
"""

import advice
import evaluation as errors
import harness
import queries  # noqa: F401
import repairs
import speed
import winding_fields as fields
import workers  # noqa: F401
import workload  # noqa: F401


def print_all(*tables):
    for table, *arguments in tables:
        print(f"\n## {table.__name__}\n")
        table(*arguments)


@harness.table
def performance():
    """The tables of fields beside peers, of threads and of stages: docs/performance.md. Takes about twelve minutes."""
    print_all((speed.stages,), (speed.fields,), (speed.threads,))


@harness.table
def evaluation(folder):
    """All tables and pictures of docs/evaluation.md and docs/signs.md, and that of closed holes. Takes about an hour."""
    print_all((errors.signs, folder), (errors.points, folder), (errors.orientation, folder), (errors.double_sided, folder),
              (errors.close_holes, folder / "libigl__bunny.off"), (fields.winding_fields, folder), (errors.deficient_meshes, folder),
              (repairs.repair, folder), (advice.repair_warnings, folder), (advice.repair_pictures, folder))  # fmt: skip


if __name__ == "__main__":
    harness.main()
