"""Chooses the shared libraries that programs of the bundle run with.

`lib` holds what only our programs need. `spare` holds what a Vulkan driver may need as well, such as C++'s own library. A
driver may need a newer one than ours, so the system's is taken where it is new enough.
"""

import os
import pathlib
import re
import subprocess


def names_in(listing):
    """Returns the libraries that the dynamic loader, which lists them, does not find or finds too old."""
    absent = re.findall(r"^\s*(\S+) => not found", listing, re.MULTILINE)
    old = re.findall(r"(\S+): version `[^']+' not found", listing)
    return {os.path.basename(name) for name in absent + old}


def unmet(program, folders):
    """Returns the libraries that a program still needs if these folders are searched first."""
    variables = {**os.environ, "LD_LIBRARY_PATH": search_path(folders), "LD_TRACE_LOADED_OBJECTS": "1"}
    listing = subprocess.run([program], env=variables, stdout=subprocess.PIPE, stderr=subprocess.STDOUT).stdout
    return names_in(listing.decode(errors="replace"))


def search_path(folders):
    given = os.environ.get("LD_LIBRARY_PATH")
    return ":".join([*map(str, folders), *([given] if given else [])])


def choose(bundle, chosen):
    """Returns the folders to search. Fills the folder `chosen` with links to those spare libraries that the programs need.

    Raises RuntimeError if the programs cannot start on this system.
    """
    folders = [bundle / "lib", pathlib.Path(chosen)]
    about = (bundle / "bundle.txt").read_text().strip()
    for program in sorted((bundle / "bin").iterdir()):
        while names := unmet(program, folders):
            for name in sorted(names):
                link = folders[1] / name
                if link.exists() or not (bundle / "spare" / name).exists():
                    raise RuntimeError(f"this system's {name} is missing or too old for {program.name}; the bundle is of {about}")
                link.symlink_to(bundle / "spare" / name)
    return folders
