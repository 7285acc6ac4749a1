"""Runs the tests of a GoogleTest program, each in a healthy process: after a test that failed, crashed or hung, a new one."""

import argparse
import fnmatch
import queue
import re
import subprocess
import sys
import threading
import time

TEST_SECONDS = 120  # A test that takes longer hangs.
RESULT = re.compile(r"\[ +(OK|SKIPPED|FAILED) +\] ([^\s,]+)")
START = re.compile(r"\[ RUN +\] (\S+)")


class Lines:
    """The lines that a program prints, as they come."""

    def __init__(self, process):
        self.lines = queue.Queue()
        threading.Thread(target=self.read, args=(process.stdout,), daemon=True).start()

    def read(self, stream):
        with stream:
            for line in stream:
                self.lines.put(line)
        self.lines.put(None)

    def next(self, seconds):
        """Returns the next line, or None at the end. Raises queue.Empty if neither comes in time."""
        return self.lines.get(timeout=seconds)


def tests_of(program, patterns, part, parts):
    """Returns the tests whose names match one of the patterns. Splits them into parts and returns one."""
    listing = subprocess.run([program, "--gtest_list_tests"], stdout=subprocess.PIPE, check=True).stdout.decode()
    tests, suite = [], ""
    for line in listing.splitlines():
        name = line.partition("#")[0].strip()
        if not line.startswith(" "):
            suite = name
        elif any(fnmatch.fnmatchcase(suite + name, pattern) for pattern in patterns):
            tests.append(suite + name)
    return tests[part - 1 :: parts]


def run_until_trouble(program, tests, deadline, results):
    """Runs tests until one fails, crashes or hangs, and adds their results."""
    command = [program, "--gtest_filter=" + ":".join(tests)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace")
    lines, test = Lines(process), tests[0]
    trouble = None
    try:
        while (line := lines.next(max(0, min(TEST_SECONDS, deadline - time.monotonic())))) is not None:
            if not line.startswith("Note: Google Test filter"):  # It lists all tests.
                print(line, end="", flush=True)
            if found := START.search(line):
                test = found[1]
            elif (found := RESULT.search(line)) and found[2] == test:
                results[test] = found[1]
                if found[1] == "FAILED":
                    return
        if process.wait() != 0 or test not in results:
            trouble = f"CRASHED with exit code {process.returncode}"
    except queue.Empty:
        trouble = "HUNG" if time.monotonic() < deadline else "NOT DONE, for no time was left"
    finally:
        process.kill()
        process.wait()
    if trouble:
        results[f"after {test}" if test in results else test] = trouble


def run(program, tests, seconds):
    """Returns {test: result}."""
    deadline = time.monotonic() + seconds
    results = {}
    while (left := [test for test in tests if test not in results]) and time.monotonic() < deadline:
        run_until_trouble(program, left, deadline, results)
    return {**results, **{test: "NOT RUN, for no time was left" for test in left}}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("patterns", nargs="+", help="names of the tests, with * and ?")
    parser.add_argument("--part", type=int, nargs=2, default=(1, 1), metavar=("K", "N"), help="run part K of N")
    parser.add_argument("--seconds", type=float, required=True, help="longest time of all tests")
    arguments = parser.parse_args()
    results = run(arguments.program, tests_of(arguments.program, arguments.patterns, *arguments.part), arguments.seconds)
    counts = {kind: list(results.values()).count(kind) for kind in ("OK", "SKIPPED")}
    bad = {test: result for test, result in results.items() if result not in counts}
    print(f"\n{counts['OK']} passed, {counts['SKIPPED']} skipped, {len(bad)} failed")
    for test, result in bad.items():
        print(f"  {test}: {result}")
    sys.exit(0 if counts["OK"] and not bad else 1)


if __name__ == "__main__":
    main()
