#!/usr/bin/env python3
"""Writes a bill of materials (CycloneDX 1.6) of a wheel: the packages of this distribution whose headers were compiled in,
and those whose libraries it brings along. scripts/release.sh calls it.

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


def output(*command: str, folder: str | None = None) -> list[str]:
    return subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True).stdout.splitlines()


def owners(patterns: set[str]) -> set[str]:
    """Returns the packages that own these files."""
    found = subprocess.run(["dpkg-query", "-S", *sorted(patterns)], capture_output=True, text=True).stdout
    return {line.split(":")[0].split(",")[0] for line in found.splitlines() if not line.startswith("diversion")}


def compiled_headers(folder: str) -> set[str]:
    """Returns the headers outside of the project that the compiler has read."""
    lines = output("ninja", "-t", "deps", folder=folder)
    return {os.path.realpath(line.strip()) for line in lines if line.startswith("    /usr/include/")}


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
    components = [component(package, distribution)
                  for package in sorted(owners(compiled_headers(build)) | owners(bundled_libraries(wheel)))]
    digest = hashlib.sha256(Path(wheel).read_bytes()).hexdigest()
    time = datetime.datetime.fromtimestamp(int(os.environ["SOURCE_DATE_EPOCH"]), datetime.timezone.utc)
    root = {"type": "application", "bom-ref": "raymap", "name": "raymap", "version": version,
            "licenses": [{"license": {"id": "Apache-2.0"}}], "hashes": [{"alg": "SHA-256", "content": digest}]}
    document = {"bomFormat": "CycloneDX", "specVersion": "1.6", "version": 1,
                "serialNumber": f"urn:uuid:{uuid.UUID(digest[:32])}",
                "metadata": {"timestamp": time.isoformat(), "component": root}, "components": components,
                "dependencies": [{"ref": "raymap", "dependsOn": [each["bom-ref"] for each in components]}]}
    if not any(each["name"].startswith("libtbb") for each in components):
        sys.exit(f"{path}: oneTBB is not among the packages, so they are incomplete")
    Path(path).write_text(json.dumps(document, indent=1) + "\n")
    print(f"{path}: {len(components)} packages")


main()
