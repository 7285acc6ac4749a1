#!/usr/bin/env python3
"""Writes a bill of materials (CycloneDX 1.6) of a wheel: what it was compiled of, by the headers, and the packages of this
distribution whose libraries it brings along. Fails on a header of unknown origin. scripts/release.sh and check_wheel.sh
call it; the environment of scripts/wheel.sh must still be there.

sbom.py BUILD_FOLDER WHEEL OUTPUT
"""

import datetime
import hashlib
import json
import os
import re
import subprocess
import sys
import uuid
import zipfile
from pathlib import Path

# Libraries that the distribution does not have, by a part of their headers' paths: package URL, licence, header with the
# version.
FOREIGN = {
    "/site-packages/nanobind/ext/robin_map/": ("pkg:github/tessil/robin-map", "MIT", "robin_growth_policy.h"),
    "/site-packages/nanobind/": ("pkg:pypi/nanobind", "BSD-3-Clause", "nanobind.h"),
    "/include/python3": ("pkg:generic/cpython", "PSF-2.0", "patchlevel.h"),
}


def output(*command: str, folder: str | None = None) -> list[str]:
    return subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True).stdout.splitlines()


def owners(patterns: set[str]) -> set[str]:
    """Returns the packages that own these files."""
    found = subprocess.run(["dpkg-query", "-S", *sorted(patterns)], capture_output=True, text=True).stdout
    return {line.split(":")[0].split(",")[0] for line in found.splitlines() if not line.startswith("diversion")}


def compiled_headers(folder: str) -> set[str]:
    """Returns the files that the compiler has read."""
    lines = output("ninja", "-t", "deps", folder=folder)
    return {os.path.realpath(os.path.join(folder, line.strip())) for line in lines if line.startswith("    ")}


def foreign(headers: set[str]) -> dict[str, list[str]]:
    """Returns the headers that are neither the distribution's nor under the project's folder, by their part of FOREIGN."""
    own = f"{Path(__file__).resolve().parent.parent}/"
    found: dict[str, list[str]] = {}
    for path in sorted(headers):
        part = next((part for part in FOREIGN if part in path), None)
        if part and not path.startswith("/usr/"):
            found.setdefault(part, []).append(path)
        elif not path.startswith(("/usr/", own)):
            sys.exit(f"{path}: FOREIGN of scripts/sbom.py does not say whose header this is")
    return found


def foreign_component(part: str, headers: list[str]) -> dict[str, object]:
    purl, licence, name = FOREIGN[part]
    text = next(Path(path) for path in headers if path.endswith("/" + name)).read_text()
    numbers = re.findall(r"^#define \w+_(?:MAJOR|MINOR|MICRO|PATCH)\w*\s+(\d+)", text, re.MULTILINE)
    version = ".".join(numbers[:3])
    return {"type": "library", "bom-ref": f"{purl}@{version}", "name": purl.rpartition("/")[2], "version": version,
            "purl": f"{purl}@{version}", "licenses": [{"license": {"id": licence}}]}


def bundled_libraries(wheel: str) -> set[str]:
    """Returns the names that the wheel's libraries had before auditwheel put a hash into them."""
    names = [Path(name).name for name in zipfile.ZipFile(wheel).namelist() if ".libs/" in name]
    return {"*/" + re.sub(r"-[0-9a-f]{8}([.]|$)", r"\1", name) for name in names}


def licences(package: str) -> list[dict[str, dict[str, str]]]:
    text = Path(f"/usr/share/doc/{package}/copyright").read_text(errors="replace")
    names = sorted(set(re.findall(r"^License: *(\S.*)$", text, re.MULTILINE)))
    return [{"license": {"name": name}} for name in names]


def component(package: str, distribution: str) -> dict[str, object]:
    version, architecture = output("dpkg-query", "-W", "-f", "${Version}\n${Architecture}", package)[:2]
    purl = f"pkg:deb/{distribution}/{package}@{version}?arch={architecture}"
    return {"type": "library", "bom-ref": purl, "name": package, "version": version, "purl": purl,
            "licenses": licences(package)}


def main() -> None:
    build, wheel, path = sys.argv[1:]
    version = Path(wheel).name.split("-")[1]
    distribution = next(line[3:] for line in Path("/etc/os-release").read_text().splitlines() if line.startswith("ID="))
    headers = compiled_headers(build)
    packages = owners({path for path in headers if path.startswith("/usr/")}) | owners(bundled_libraries(wheel))
    components = [component(package, distribution) for package in sorted(packages)]
    components += [foreign_component(part, paths) for part, paths in foreign(headers).items()]
    digest = hashlib.sha256(Path(wheel).read_bytes()).hexdigest()
    time = datetime.datetime.fromtimestamp(int(os.environ["SOURCE_DATE_EPOCH"]), datetime.timezone.utc)
    root = {"type": "application", "bom-ref": "raymap", "name": "raymap", "version": version,
            "licenses": [{"license": {"id": "Apache-2.0"}}], "hashes": [{"alg": "SHA-256", "content": digest}]}
    document = {"bomFormat": "CycloneDX", "specVersion": "1.6", "version": 1,
                "serialNumber": f"urn:uuid:{uuid.UUID(digest[:32])}",
                "metadata": {"timestamp": time.isoformat(), "component": root}, "components": components,
                "dependencies": [{"ref": "raymap", "dependsOn": [each["bom-ref"] for each in components]}]}
    for name in ("libtbb", "nanobind", "robin-map"):
        if not any(each["name"].startswith(name) for each in components):
            sys.exit(f"{path}: {name} is not among the packages, so they are incomplete")
    Path(path).write_text(json.dumps(document, indent=1) + "\n")
    print(f"{path}: {len(components)} packages")


main()
