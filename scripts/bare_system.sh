#!/usr/bin/env bash
# Makes a bare system of this distribution (debootstrap), or runs a command in one, without a network. Needs root.
#
# scripts/bare_system.sh make FOLDER PACKAGE,...
# scripts/bare_system.sh run FOLDER COMMAND...
set -euo pipefail
action=$1 folder=$2
shift 2
if [[ $action == make ]]; then
  type -P debootstrap >/dev/null || apt-get install -y -q debootstrap </dev/null
  debootstrap --variant=minbase --include="$1" "$(. /etc/os-release && echo "$VERSION_CODENAME")" "$folder" \
    >"$folder.log" || { tail -n 20 "$folder.log" && exit 1; }
else
  # /proc vanishes with the namespace.
  exec unshare --mount --net bash -euo pipefail -c \
    'mount -t proc proc "$0/proc" && exec chroot "$0" env -i PATH=/usr/bin:/bin "$@"' "$folder" "$@"
fi
