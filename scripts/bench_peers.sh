# Configures the folder of the benchmarks, `build`, and installs the Python peers there. Other scripts source it.
build=build/bench
scripts/install.sh --bench >&2
cmake --preset release -B "$build" -DRAYMAP_BUILD_BENCH=ON -DRAYMAP_BUILD_TESTS=OFF >&2
if [ ! -e "$build/venv/complete" ]; then
  python3 -m venv "$build/venv" >&2
  "$build/venv/bin/pip" install --quiet numpy >&2
  for peer in libigl open3d mesh2sdf; do
    "$build/venv/bin/pip" install --quiet "$peer" >&2 || echo "$peer does not install here" >&2
  done
  touch "$build/venv/complete"
fi
