#!/bin/sh
# Tests and measures a graphics card with the programs beside this file. `run.sh --help` says how.
exec python3 "$(dirname "$0")/run.py" "$@"
