#!/usr/bin/env python3
"""Compiles every kernel of the GPU backend for AMD cards that are absent, and checks the compiled code.

Mesa's driver RADV has the cards' real compiler and needs no card. Prints a table of them. Ends
with 1 if a kernel does not compile, spills registers, needs scratch memory, or leaves room for less than a quarter of a
card's waves, unless tests/kernels/exceptions.txt allows it. An exception that is no longer needed also fails.

check_kernels.py [PROGRAM]: PROGRAM is list_kernels. By default the script builds it.
"""

import collections
import json
import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
EXCEPTIONS = ROOT / "tests/kernels/exceptions.txt"
DRIVERS = ("/usr/share/vulkan/icd.d", "/etc/vulkan/icd.d")
# Families of cards with the subgroup sizes that they have; the first is the driver's own choice.
CARDS = [("gfx1100", 64), ("gfx1100", 32), ("navi21", 64), ("navi21", 32), ("vega10", 64), ("polaris10", 64)]
LEAST_SHARE_OF_WAVES = 0.25


def program():
    if len(sys.argv) > 1:
        return sys.argv[1]
    log = {"stdout": sys.stderr, "check": True, "cwd": ROOT}
    subprocess.run(["cmake", "--preset", "release"], **log)
    subprocess.run(["cmake", "--build", "--preset", "release", "--target", "list_kernels"], **log)
    return ROOT / "build/release/bin/list_kernels"


def driver():
    found = [path for folder in DRIVERS for path in pathlib.Path(folder).glob("radeon_icd.*.json")]
    if not found:
        sys.exit("RADV is not installed: install mesa-vulkan-drivers")
    return str(found[0])


def compile_kernels(program, family, size):
    """Returns the kernels by name and constants, and the names of the shaders that no kernel uses."""
    environment = {**os.environ, "RADV_FORCE_FAMILY": family, "VK_ICD_FILENAMES": driver(),
                   "VK_DRIVER_FILES": driver(), "MESA_SHADER_CACHE_DISABLE": "1",
                   "RAYMAP_CACHE": "off"}
    result = subprocess.run([program, str(size)], env=environment, stdout=subprocess.PIPE, text=True)
    if result.returncode:
        sys.exit(f"the kernels do not compile for {family} with {size} invocations per subgroup")
    *kernels, last = map(json.loads, result.stdout.splitlines())
    return {(k["kernel"], *k["constants"]): {**k["statistics"], **k} for k in kernels}, last["not_made"]


def most_waves(kernels):
    """Returns the number of waves that a SIMD of the card holds: that of the smallest kernels."""
    return max(kernel["Subgroups per SIMD"] for kernel in kernels.values())


def findings(kernels, not_made):
    """Yields the name of a kernel, what is wrong with it, and the figure."""
    for name in not_made:
        yield name, "absent", 0
    most = most_waves(kernels)
    for (name, *_), kernel in kernels.items():
        if spilled := kernel["Spilled VGPRs"] + kernel["Spilled SGPRs"]:
            yield name, "spills", spilled
        if kernel["Scratch size"]:
            yield name, "scratch", kernel["Scratch size"]
        if kernel["Subgroups per SIMD"] < LEAST_SHARE_OF_WAVES * most:
            yield name, "waves", kernel["Subgroups per SIMD"]


def read_exceptions():
    """Returns the exceptions: by card, kernel and finding."""
    lines = (line.split("#")[0].split() for line in EXCEPTIONS.read_text().splitlines())
    exceptions = set()
    for card, kernel, finding, record in filter(None, lines):
        if not (ROOT / record).exists():
            sys.exit(f"{EXCEPTIONS.name}: there is no record {record}")
        exceptions.add((card, kernel, finding))
    return exceptions


def check(results):
    exceptions = read_exceptions()
    used, problems = set(), []
    for (family, size), (kernels, not_made) in results.items():
        for kernel, finding, figure in findings(kernels, not_made):
            allowed = {(card, kernel, finding) for card in (family, "all")} & exceptions
            used |= allowed
            if not allowed:
                problems.append(f"{kernel} for {family} with {size} invocations per subgroup: {finding} {figure:g}")
    for card, kernel, finding in sorted(exceptions - used):
        problems.append(f"{EXCEPTIONS.name}: {kernel} no longer needs the exception '{finding}' for {card}; remove it")
    return problems


def print_table(results):
    (first, (kernels, _)), *others = results.items()
    most = {card: most_waves(found) for card, (found, _) in results.items()}
    head = ["kernel", "VGPRs", "spills", "scratch B", "shared B", f"waves of {most[first]:g}", "instructions",
            "latency", *(f"{family}, {size}: of {most[family, size]:g}" for (family, size), _ in others)]
    print(f"Figures are for {first[0]} with {first[1]} invocations per subgroup; the last columns are waves of others.\n")
    print("| " + " | ".join(head) + " |\n|" + "---|" * len(head))
    for shader, variants in by_shader(results).items():
        for number, (label, keys) in enumerate(variants):
            s = kernels[keys[first]]
            figures = [s["VGPRs"], s["Spilled VGPRs"] + s["Spilled SGPRs"], s["Scratch size"], s["LDS size"],
                       s["Subgroups per SIMD"], s["Instructions"], s["Latency"],
                       *(results[card][0][keys[card]]["Subgroups per SIMD"] for card, _ in others)]
            print(f"| {label} | " + " | ".join(f"{figure:.0f}" for figure in figures) + " |")


def by_shader(results):
    """Returns the variants of each shader. A variant has one key per card, for constants may depend on the card."""
    shaders = collections.defaultdict(dict)
    for card, (kernels, _) in results.items():
        keys = collections.defaultdict(list)
        for key in kernels:
            keys[key[0]].append(key)
        for shader, variants in keys.items():
            shaders[shader][card] = sorted(variants)
    first = next(iter(results))
    return {shader: [(variant_name(key, cards[first]), {card: cards[card][i] for card in cards})
                     for i, key in enumerate(cards[first])] for shader, cards in sorted(shaders.items())}


def variant_name(key, variants):
    """Names a kernel by its shader, with the constants if the shader has more than one kernel."""
    return key[0] if len(variants) == 1 else f"{key[0]} ({', '.join(map(str, key[2:]))})"


def main():
    executable = program()
    results = {card: compile_kernels(executable, *card) for card in CARDS}
    print_table(results)
    problems = check(results)
    for problem in problems:
        print(problem, file=sys.stderr)
    print(f"{sum(len(kernels) for kernels, _ in results.values())} kernels compiled, {len(problems)} problems",
          file=sys.stderr)
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()
