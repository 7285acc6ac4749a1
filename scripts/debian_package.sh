#!/usr/bin/env bash
# Builds the Debian packages raymap and libraymap-dev of the files in Git's index, in build/debian, and runs lintian.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
scripts/install.sh --release
version=$(sed -n 's/^project(raymap VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
maintainer=$(sed -n 's/^Maintainer: //p' packaging/debian/control)
tree=build/debian/raymap
export SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct)}

rm -rf build/debian
mkdir -p "$tree"
git checkout-index --all --prefix="$tree/"
cp -r packaging/debian "$tree/debian"
cat >"$tree/debian/changelog" <<END
raymap ($version) unstable; urgency=medium

  * CHANGELOG.md lists what is new.

 -- $maintainer  $(date --utc --rfc-email --date="@$SOURCE_DATE_EPOCH")
END
cd "$tree"
export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1  # Builds share what they compiled.
DEB_BUILD_OPTIONS="nocheck noautodbgsym ${DEB_BUILD_OPTIONS:-}" dpkg-buildpackage --build=binary --unsigned-changes >../log 2>&1 ||
  { tail -n 40 ../log && exit 1; }
cd ..
lintian --fail-on error,warning --info ./*.changes
ls ./*.deb
