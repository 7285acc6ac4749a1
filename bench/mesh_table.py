"""The table MESHES.tsv of a folder of meshes."""

import csv


def mesh_rows(folder):
    """Returns the rows of the folder's table, by column."""
    with open(folder / "MESHES.tsv", newline="") as table:
        return list(csv.DictReader(table, delimiter="\t", quoting=csv.QUOTE_NONE))
