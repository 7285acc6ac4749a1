#!/usr/bin/env bash
# Makes a bare system of a distribution (mmdebstrap), by default this one, or runs something in one, without a network. Needs
# root.
#
# scripts/bare_system.sh make FOLDER PACKAGE,... [DISTRIBUTION]
# scripts/bare_system.sh run FOLDER COMMAND...
# scripts/bare_system.sh readme FOLDER BIN: README's lines for the shell; the system's folder BIN has the program raymap
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
action=$1 folder=$2
shift 2
case $action in
  make)
    type -P mmdebstrap >/dev/null || apt-get install -y -q --no-install-recommends mmdebstrap </dev/null
    # A mirror may be late with distributions that are not released.
    mmdebstrap --variant=minbase --aptopt='Acquire::Check-Valid-Until "false"' --include="$1" \
      "${2:-$(. /etc/os-release && echo "$VERSION_CODENAME")}" "$folder" \
      >"$folder.log" 2>&1 || { tail -n 20 "$folder.log" && exit 1; }
    ;;
  run)
    # /proc vanishes with the namespace.
    exec unshare --mount --net bash -euo pipefail -c \
      'mount -t proc proc "$0/proc" && exec chroot "$0" env -i PATH=/usr/bin:/bin "$@"' "$folder" "$@"
    ;;
  readme)
    mkdir "$folder/readme"
    sed -n '/^## Use$/,/^## /s/^    //p' README.md >"$folder/readme/lines.sh"
    exec scripts/bare_system.sh run "$folder" bash -euo pipefail -c '
      cd readme
      export PATH=$0:$PATH
      bash -eux lines.sh
      for file in $(grep -oE "[a-z]+\.(png|vdb|html|stl)" lines.sh); do [[ -s $file ]] || exit 1; done' "$1"
    ;;
esac
