#!/usr/bin/env bash
# Builds the documentation site: scripts/site.sh [OUT]. OUT is build/site by default; open its index.html, no server is
# needed. Sphinx joins the pages of docs/, the Python package's docstrings, the public headers (by Doxygen) and the help of
# each command. Needs the release build with the Python package (scripts/test.sh makes it).
# Fails on any warning: a link that leads nowhere, a page that no list of pages has, a comment that cannot be read.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
out=$(realpath -m "${1:-build/site}") work=build/site-work
python=$(scripts/python_env.sh --site)
raymap=build/release/bin/raymap

rm -rf "$work" "$out"
mkdir -p "$work"
# Pages at the same paths as in the tree, so that links between them and to other files hold.
cp -r *.md LICENSE CITATION.cff docs examples include src docs/site/{conf.py,index.rst,reference} "$work/"
mkdir -p "$work/reference/cpp"

(cat docs/site/Doxyfile && echo "OUTPUT_DIRECTORY = $work/doxygen") | doxygen -
for header in include/raymap/*.h; do
  name=${header##*/}
  printf '%s\n' "$name" "${name//?/=}" '' ".. doxygenfile:: $name" >"$work/reference/cpp/${name%.h}.rst"
done
rm "$work/reference/cpp/c.rst"  # It has a page of its own.

# The help of each command, in the width of a page.
commands=$("$raymap" --help | sed -n '/^Commands:/,/^$/s/^  \([a-z]*\) .*/\1/p')
{
  printf '%s\n' 'Help of the commands' '====================' ''
  for command in $commands; do
    printf '%s\n' "$command" "${command//?/-}" '' '.. code-block:: text' ''
    COLUMNS=90 "$raymap" "$command" --help | sed 's/^./   &/'
    echo
  done
} >"$work/reference/commands.rst"

PYTHONPATH=build/release/python "$python" -m sphinx -q -W --keep-going -j auto -d "$work/doctrees" "$work" "$out"
echo "$out/index.html: $(find "$out" -name '*.html' | wc -l) pages"
