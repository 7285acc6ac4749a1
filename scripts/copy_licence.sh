#!/usr/bin/env bash
# Copies the licence of the package that a shared library came from: scripts/copy_licence.sh LIBRARY FOLDER
set -euo pipefail
package=$(dpkg-query -S "*/$(basename "$1")" | head -n 1 | cut -d: -f1)
mkdir -p "$2"
cp "/usr/share/doc/$package/copyright" "$2/$package.txt"
