#!/usr/bin/env bash
# Makes the files of a release in build/release-files: a source archive, wheels of it for the named Pythons (by default
# python3), Debian packages, archives of the program, wheels and archives for aarch64, a bill of materials, and checksums.
# Installs those of x86-64 in bare systems, and runs README's lines there. Takes what Git's index has. Needs root.
#
# scripts/release.sh [PYTHON...]: the last one, CPython 3.12 or later, also builds that for aarch64
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
out=build/release-files
env=build/release-env
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
if [[ $# -eq 0 ]]; then set -- python3; fi
export SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct)}
most_megabytes=15

scripts/install.sh --release
rm -rf "$out" build/wheels build/sdist
mkdir -p "$out" build/sdist
python3 -m venv --clear "$env"
"$env/bin/python" -m pip install --quiet --disable-pip-version-check build 'cyclonedx-python-lib[json-validation]'
git checkout-index --all --prefix="$work/tree/"
"$env/bin/python" -m build --sdist --outdir "$out" "$work/tree"
tar -xzf "$out"/raymap-*.tar.gz -C build/sdist
scripts/small_libraries.sh
for python in "$@"; do
  CMAKE_PREFIX_PATH=$PWD/build/small-libraries LD_LIBRARY_PATH=$PWD/build/small-libraries/lib scripts/wheel.sh "$python" build/sdist/raymap-*
done
native=$(ls -t build/wheels/*.whl | head -n 1)
scripts/sbom.py "$(ls -td build/sdist/raymap-*/build/wheel-* | head -n 1)" "$native" "$out/raymap.cdx.json"
scripts/aarch64.sh sysroot
scripts/small_libraries.sh "$PWD/build/aarch64-sysroot"
RAYMAP_SYSROOT=$PWD/build/aarch64-sysroot scripts/wheel.sh "${@: -1}" build/sdist/raymap-*
foreign=$(ls -t build/wheels/*.whl | head -n 1)
scripts/archive.sh "$native" "$out"
RAYMAP_SYSROOT=$PWD/build/aarch64-sysroot scripts/archive.sh "$foreign" "$out"
cp build/wheels/*.whl "$out"
scripts/debian_package.sh
cp build/debian/*.deb "$out"

"$env/bin/python" - "$out/raymap.cdx.json" <<'END'
import sys
from pathlib import Path
from cyclonedx.schema import SchemaVersion
from cyclonedx.validation.json import JsonStrictValidator

fault = JsonStrictValidator(SchemaVersion.V1_6).validate_str(Path(sys.argv[1]).read_text())
if fault: sys.exit(f"{sys.argv[1]}: {fault}")
END
scripts/check_debian.sh
system_wheel=(build/wheels/*-"$(/usr/bin/python3 -c 'import sys; print("cp%d%d" % sys.version_info[:2])')"-*_x86_64.whl)
if [[ -e ${system_wheel[0]} ]]; then scripts/check_wheel.sh "${system_wheel[0]}"; fi
if [[ $native == *-abi3-* ]]; then scripts/check_wheel.sh "$native" forky; fi  # The next Debian has CPython 3.14.
scripts/aarch64.sh check "$foreign"
scripts/bare_system.sh make "$work/bare" tar,xz-utils
cp "$out"/raymap-*-linux-x86_64.tar.xz "$work/bare"
scripts/bare_system.sh run "$work/bare" bash -c 'tar -xf raymap-*.tar.xz && mv raymap-*/ "a folder"'
scripts/bare_system.sh readme "$work/bare" "/a folder/bin"

mkdir "$work/wheels" && cp "$out"/*.whl "$work/wheels"  # Without the source, which pip would build.
for python in "$@"; do
  "$python" -m venv --clear "$work/env"
  "$work/env/bin/python" -m pip install --quiet --disable-pip-version-check numpy typing_extensions
  "$work/env/bin/python" -m pip install --quiet --disable-pip-version-check --no-index --find-links "$work/wheels" raymap
  (mkdir -p "$work/trial" && cp -r README.md docs python tests/consumer/tetrahedron.dae python/tests/{use_wheel,pages}.py "$work/trial" &&
    cd "$work/trial" && VK_ICD_FILENAMES=/nowhere "$work/env/bin/python" use_wheel.py && rm -rf "$work/trial")
done

(cd "$out" && sha256sum -- * >SHA256SUMS)
ls -l "$out"
if find "$out" -name '*.whl' -size +"$((most_megabytes * 1000000))c" | grep .; then
  echo "These are larger than $most_megabytes MB." >&2
  exit 1
fi
