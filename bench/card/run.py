"""Tests and measures a graphics card. Needs x86-64 Linux, Python 3.8 and the card's Vulkan driver, and nothing else."""

import argparse
import collections
import contextlib
import datetime
import json
import os
import pathlib
import platform
import shutil
import signal
import subprocess
import sys
import tarfile
import tempfile
import time

import libraries

BUNDLE = pathlib.Path(__file__).resolve().parent
STEP_SECONDS = 480  # No step takes longer.
MEASURED_SHARE = 7 / 8  # Share of a step's time for its work, so that it can report before it is ended.
LEAST_SECONDS = 20  # A step is not begun with less.
QUICK_TESTS = ("*VulkanScan*", "VulkanDevice*", "VulkanBuffer*", "VulkanCommands*", "VulkanDispatch*",
               "VulkanPipelines*")

Step = collections.namedtuple("Step", "name what command")


def steps_of(device, is_quick):
    """Returns all steps. A command's `{folder}` is the step's own, and `{seconds}` is how long it may work."""
    python = sys.executable

    def tests(name, what, program, patterns, part=1, parts=1):
        return Step(name, what, [python, BUNDLE / "run_gtest.py", BUNDLE / "bin" / program, *patterns,
                                 "--part", part, parts, "--seconds", "{seconds}"])

    def tables(name, what, *names):
        command = [python, BUNDLE / "gpu_tables.py", BUNDLE / "bin/gpu_bench", "{folder}", "--seconds", "{seconds}"]
        command += ["--quick"] if is_quick else []
        command += ["--device", device] if device else []
        for table in names:
            command += ["--table", table]
        if name == "meshes" and any((BUNDLE / "meshes").glob("*.*")):
            command.append(BUNDLE / "meshes")
        return Step(name, what, command)

    largest = "scan" if is_quick else "million"
    vulkan = QUICK_TESTS if is_quick else ("*",)
    return [
        Step("devices", "raymap devices --test: small versions of all stages, compared with the CPU",
             [BUNDLE / "bin/raymap", "devices", "--test", *([device] if device else [])]),
        tests("vulkan_tests_1", "one half of the tests of the GPU", "vulkan_tests", vulkan, 1, 2),
        tests("vulkan_tests_2", "the other half", "vulkan_tests", vulkan, 2, 2),
        tables("latencies", "what steps without work cost", "latencies"),
        tables("fields", "tables of whole fields, stages and the harmonic solve", "fields", "stages", "solve", "coarse"),
        tables("counted-scan", "counted work beside measured times, the scan", "counted-scan"),
        tables("counted-million", "counted work beside measured times, the largest mesh", f"counted-{largest}"),
        tables("meshes", "times over the meshes, beside the CPU", "meshes"),
        tables("resolutions", "times over the resolutions, beside the CPU", "resolutions"),
    ]


def data_folders():
    """Returns the folders in which the loader looks for drivers. In some containers NVIDIA's lies in one that it does not
    search by itself. A driver that is found twice has each device twice."""
    folders = os.environ.get("XDG_DATA_DIRS", "/usr/local/share:/usr/share")
    installed = [pathlib.Path(folder, "vulkan/icd.d") for folder in ("/etc", *folders.split(":"))]
    is_found = any(next(folder.glob("*nvidia*"), None) for folder in installed)
    return folders if is_found else folders + ":/usr/local/nvidia/share"


def environment(device, scratch):
    """Returns the environment of all steps."""
    return {
        **os.environ,
        "LD_LIBRARY_PATH": libraries.search_path(libraries.choose(BUNDLE, tempfile.mkdtemp(dir=scratch))),
        "RAYMAP_CACHE": str(scratch),
        "RAYMAP_MESHES": str(BUNDLE / "meshes"),
        "RAYMAP_REQUIRE_VULKAN": "1",
        "RAYMAP_VULKAN_VALIDATION": "off",  # The layer is not in the bundle.
        "XDG_DATA_DIRS": data_folders(),
        **({"RAYMAP_VULKAN_DEVICE": device.rpartition(":")[2]} if device else {}),
    }


def kill(process):
    """Kills a step and all that it started. A process that waits for a broken driver may outlive it."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    with contextlib.suppress(subprocess.TimeoutExpired):
        process.wait(10)


def run_step(step, output, variables, seconds):
    """Returns the result of a step, which is also kept in its folder with its log."""
    folder = output / step.name
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    values = {"{folder}": str(folder), "{seconds}": str(MEASURED_SHARE * seconds)}
    command = [values.get(part, str(part)) for part in step.command]
    start = time.monotonic()
    with open(folder / "log.txt", "wb") as log:
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log, env=variables,
                                   cwd=folder, start_new_session=True)
        try:
            outcome = f"exit code {process.wait(seconds)}"
        except subprocess.TimeoutExpired:
            outcome = f"ended after {seconds:.0f} s"
        finally:
            kill(process)
    result = {"step": step.name, "outcome": outcome, "passed": process.returncode == 0,
              "seconds": round(time.monotonic() - start, 1)}
    (folder / "result.json").write_text(json.dumps(result))
    return result


def machine():
    """Returns what is worth knowing about this machine, as text."""
    lines = [(BUNDLE / "bundle.txt").read_text().strip(), platform.platform(), " ".join(platform.libc_ver()),
             f"Python {platform.python_version()}, {os.cpu_count()} threads"]
    with contextlib.suppress(OSError, subprocess.SubprocessError):
        lines.append(subprocess.run(["nvidia-smi"], stdout=subprocess.PIPE, timeout=30).stdout.decode(errors="replace"))
    return "\n".join(lines)


def write_summary(output, steps, about):
    """Writes the results of all steps that have run, now or earlier, and packs the folder."""
    rows = []
    for step in steps:
        file = output / step.name / "result.json"
        result = json.loads(file.read_text()) if file.exists() else {"outcome": "not run", "seconds": 0}
        rows.append(f"| {step.name} | {result['outcome']} | {result['seconds']} |")
    lines = ["| step | outcome | seconds |", "|---|---|---|", *rows, "", about, ""]
    (output / "summary.md").write_text("\n".join(lines))
    packed = output / "results.tar.gz"
    with tarfile.open(f"{packed}.new", "w:gz") as archive:
        for entry in sorted(output.iterdir()):
            if not entry.name.startswith(packed.name):
                archive.add(entry, arcname=f"{output.name}/{entry.name}")
    os.replace(f"{packed}.new", packed)


def say(text):
    """Prints a line, while anybody is left to read it."""
    try:
        print(text, flush=True)
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def run_steps(wanted, steps, output, variables, minutes):
    """Runs the wanted steps. Returns whether all have passed."""
    about = f"{datetime.datetime.now().isoformat(' ', 'seconds')}\n{machine()}"
    write_summary(output, steps, about)
    deadline = time.monotonic() + 60 * minutes
    is_good = True
    for step in wanted:
        seconds = min(STEP_SECONDS, deadline - time.monotonic())
        if seconds < LEAST_SECONDS:
            say(f"{step.name}: not run, for no time is left")
            is_good = False
            continue
        say(f"{step.name}: {step.what}")
        result = run_step(step, output, variables, seconds)
        is_good = is_good and result["passed"]
        say(f"{step.name}: {result['outcome']}, {result['seconds']} s")
        if not result["passed"]:
            log = (output / step.name / "log.txt").read_text(errors="replace")
            say("".join(f"    {line}\n" for line in log.splitlines()[-15:]))
        write_summary(output, steps, about)
    return is_good


def parse_arguments():
    parser = argparse.ArgumentParser(
        prog="run.sh", description=__doc__,
        epilog=f"Each step ends within {STEP_SECONDS // 60} minutes and leaves its files in OUT/STEP. The next one starts "
               "even if it fails or hangs. The exit code is 0 if all passed. OUT/summary.md lists the outcomes; "
               "OUT/results.tar.gz holds all files, and is the one file to send.")
    parser.add_argument("out", metavar="OUT", nargs="?", type=pathlib.Path, help="the folder for the results")
    parser.add_argument("steps", metavar="STEP", nargs="*", help="the steps to run; all if none is named")
    parser.add_argument("--list", action="store_true", help="list the steps")
    parser.add_argument("--device", metavar="vulkan:K", help="the GPU; the best if not given")
    parser.add_argument("--minutes", type=float, default=float("inf"), help="end within this time; later steps are not run")
    parser.add_argument("--quick", action="store_true", help="few tests and small grids, for a driver in software")
    arguments = parser.parse_intermixed_args()  # Lets steps follow options.
    steps = {step.name: step for step in steps_of(arguments.device, arguments.quick)}
    if not arguments.list and not arguments.out:
        parser.error("name the folder for the results: run.sh OUT")
    for name in arguments.steps:
        if name not in steps:
            parser.error(f"there is no step '{name}', only {', '.join(steps)}")
    return arguments, steps


def make_output(output):
    """Makes the folder of the results. Raises RuntimeError if it holds other files, which steps might replace."""
    output.mkdir(parents=True, exist_ok=True)
    if any(output.iterdir()) and not (output / "summary.md").exists():
        raise RuntimeError(f"{output} holds other files; name a new folder")


def main():
    arguments, steps = parse_arguments()
    if arguments.list:
        print("\n".join(f"{step.name:16} {step.what}" for step in steps.values()))
        return 0
    wanted = [steps[name] for name in arguments.steps] or list(steps.values())
    output = arguments.out.resolve()
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # An end on request kills the running step, too.
    signal.signal(signal.SIGHUP, signal.SIG_IGN)  # A lost connection ends nothing.
    with tempfile.TemporaryDirectory() as scratch:
        try:
            make_output(output)
            variables = environment(arguments.device, scratch)
            return 0 if run_steps(wanted, list(steps.values()), output, variables, arguments.minutes) else 1
        except (OSError, RuntimeError) as error:
            print(f"run.sh: {error}", file=sys.stderr)
            return 2
        except KeyboardInterrupt:
            return 130


if __name__ == "__main__":
    sys.exit(main())
