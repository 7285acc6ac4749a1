#!/usr/bin/env python3
"""Draws README's chart, docs/images/peers.svg, from the tables of docs/performance.md; `--check` only looks."""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
CHART = ROOT / "docs/images/peers.svg"
MESH = "scan 128"
WIDTH, ROW, TOP, LEFT, RIGHT = 800, 46, 96, 180, 110


def bars(text):
    """Returns the names of the programs and their CPU time over Raymap's, and Raymap's seconds."""
    seconds, peer, ratio = re.search(rf"^\| {MESH} \| ([\d.]+) \| (\w+) [\d.]+ \| ([\d.]+) \|", text, re.MULTILINE).groups()
    block = re.search(rf"^\| {MESH} \| OpenVDB.*\n(?:\| \|.*\n)*", text, re.MULTILINE)[0]
    rows = re.findall(r"^\| [^|]*\| ([^|,]+)[^|]*\| [\d.]+ \| ([\d.]+) \|", block, re.MULTILINE)
    return [("Raymap", "1"), (peer, ratio), *((name.strip(), times) for name, times in rows)], seconds


def draw(text):
    found, seconds = bars(text)
    found.sort(key=lambda bar: float(bar[1]))
    height = TOP + ROW * len(found) + 14
    scale = (WIDTH - LEFT - RIGHT) / float(found[-1][1])
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" width="560" viewBox="0 0 {WIDTH} {height}"',
             ' font-family="sans-serif" font-size="25">',
             f'<rect x="1" y="1" width="{WIDTH - 2}" height="{height - 2}" rx="14" fill="#fff" stroke="#d0d7de"/>',
             '<text x="24" y="42" font-weight="bold" fill="#1f2328">CPU time, relative to Raymap</text>',
             f'<text x="24" y="75" font-size="21" fill="#59636e">Bunny, {MESH.split()[1]} samples along the longest side;'
             f' Raymap takes {seconds} s</text>']
    for row, (name, times) in enumerate(found):
        y, length = TOP + ROW * row, scale * float(times)
        lines += [f'<text x="{LEFT - 14}" y="{y + 29}" text-anchor="end" fill="#1f2328">{name}</text>',
                  f'<rect x="{LEFT}" y="{y + 4}" width="{length:.0f}" height="34" fill="{"#d9822b" if name == "Raymap" else "#8c959f"}"/>',
                  f'<text x="{LEFT + length + 10:.0f}" y="{y + 29}" fill="#1f2328">{times} ×</text>']
    return "\n".join([*lines, "</svg>", ""])


def main():
    drawn = draw((ROOT / "docs/performance.md").read_text())
    if sys.argv[1:] != ["--check"]:
        CHART.write_text(drawn)
    elif CHART.read_text() != drawn:
        sys.exit("docs/images/peers.svg differs from docs/performance.md: run scripts/peer_chart.py")


if __name__ == "__main__":
    main()
