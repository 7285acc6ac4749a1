"""Talks with the program gpu_bench, which measures cases on a GPU and on the CPU."""

import contextlib
import json
import math
import pathlib
import select
import subprocess
import sys
import time

SETTINGS = {"exact+harmonic": ("exact", "harmonic"), "cell+rays": ("cell", "rays")}  # The second is the paper's fast one.
NO_TIME = "not measured: no time was left"

# Least number of bytes that a stage moves, with input read once and output written once: per sample, per cell of the
# lattices that cover the mesh, per triangle and per vertex. "begin" and "read_back" cross the bus and are not part of
# the totals.
MESH = (12, 12)
TRAFFIC = {
    "exact_distance": (4, 0, *MESH),
    "voxel_grid": (0, 0, 8 + MESH[0], MESH[1]),         # At least one pair of cell and triangle per triangle.
    "cell_distance": (0, 4, 8 + MESH[0], MESH[1]),
    "distance_transform": (0, 8 + 12 + 12, 0, 0),       # Three passes: values and (but in the first) places in, places out.
    "refine": (4, 4, *MESH),
    "crossings": (12, 0, *MESH),
    "ray_map": (24, 0, 0, 0),
    "winding": (16, 0, 0, 0),
    "finish": (12, 0, 0, 0),  # With the sign.
}


class Bench:
    """The program `gpu_bench`, restarted if it dies. Each case runs once. `seconds` limits the time of all cases."""

    def __init__(self, program, device, log, seconds=None):
        self.command = [program, *(["--device", device] if device else [])]
        self.log = log
        self.deadline = math.inf if seconds is None else time.monotonic() + seconds
        self.answers = {}
        self.failures = 0  # Cases without an answer, and ends of the program that nobody asked for.
        self.machine = self.start()
        if self.machine is None:
            sys.exit(self.process.wait() or 1)

    def start(self):
        """Returns the description of the device, or None if the program ended."""
        self.process = subprocess.Popen(self.command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        line = self.read_line(self.process)
        return json.loads(line) if line else None

    def seconds_left(self):
        """Returns None where there is no limit."""
        return None if self.deadline == math.inf else max(0, self.deadline - time.monotonic())

    def read_line(self, process):
        """Returns the program's next line, or nothing if it ended. Kills it when the time is over."""
        if not select.select([process.stdout], [], [], self.seconds_left())[0]:
            process.kill()
        return process.stdout.readline()

    def run(self, device, mesh, resolution, setting):
        key = (device, mesh, resolution, setting)
        if key not in self.answers:
            print(f"{device} {pathlib.Path(mesh).name} {resolution} {setting}", file=sys.stderr, flush=True)
            distance, sign = SETTINGS[setting]
            case = {"device": device, "mesh": mesh, "resolution": resolution, "distance": distance, "sign": sign}
            self.answers[key] = answer = self.ask(case)
            self.log.write(json.dumps({**case, **answer}) + "\n")
            if "error" in answer:
                print("  " + answer["error"], file=sys.stderr)
        return self.answers[key]

    def ask(self, case):
        if self.seconds_left() == 0:
            return self.fail(NO_TIME)
        if self.process.poll() is not None:
            self.failures += 1  # It answered the last case, and then ended.
            if self.start() is None:
                return self.fail("gpu_bench does not start again")
        try:
            self.process.stdin.write(json.dumps(case) + "\n")
            self.process.stdin.flush()
            line = self.read_line(self.process)
        except BrokenPipeError:
            line = ""
        if line:
            return json.loads(line)
        return self.fail(NO_TIME if self.seconds_left() == 0 else f"gpu_bench ended with {self.process.wait()}")

    def fail(self, reason):
        self.failures += 1
        return {"error": reason}

    def finish(self):
        """Ends the program. Returns whether every case has been answered and the program ended well."""
        with contextlib.suppress(BrokenPipeError):
            self.process.stdin.close()
        self.read_line(self.process)
        self.process.stdout.close()
        return self.process.wait() == 0 and self.failures == 0

    def moved(self, stage, answer):
        """Returns the bytes that a stage moves at least, or None where they depend on other things."""
        counts = [answer[name] for name in ("samples", "cells", "triangles", "vertices")]
        return sum(a * b for a, b in zip(TRAFFIC[stage], counts)) if stage in TRAFFIC else None

    def floor(self, stage, answer):
        return 1e3 * (self.moved(stage, answer) or 0) / self.machine["copy_bytes_per_second"]

    def verdict(self, value, aim):
        """Returns the aim and whether it is met. The aims are a GPU's, so a software driver gets no verdict."""
        if aim is None:
            return ""
        return f"{aim:.3g}" if self.machine["is_software"] else f"{aim:.3g} {'met' if value <= aim else 'MISSED'}"

    def print(self, *options):
        """Returns the tables that gpu_bench prints with these options."""
        command = [*self.command, *map(str, options)]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        try:
            text = process.communicate(timeout=self.seconds_left())[0]
        except subprocess.TimeoutExpired:
            process.kill()
            text = process.communicate()[0]
        if process.returncode == 0:
            return text
        reason = NO_TIME if self.seconds_left() == 0 else f"gpu_bench {options[0]} ended with {process.returncode}"
        return f"{text}\n{self.fail(reason)['error']}\n"
