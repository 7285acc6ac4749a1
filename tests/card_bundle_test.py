#!/usr/bin/env python3
"""Tests the programs of the card's bundle (bench/card), which must survive whatever a card does, on fake programs."""

import contextlib
import io
import json
import os
import queue
import shutil
import subprocess
import sys
import tarfile
import tempfile
import time
import unittest
import unittest.mock
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "bench/card"), str(ROOT / "bench")]
import gpu_program  # noqa: E402
import gpu_tables  # noqa: E402
import libraries  # noqa: E402
import run  # noqa: E402
import run_gtest  # noqa: E402

ENDLESS = 1e9  # Seconds, for what must not depend on how long work takes

# Prints what a GoogleTest program prints. Tests do what their names say.
FAKE_TESTS = """#!/usr/bin/env python3
import os, pathlib, signal, sys, time
tests = ["Works", "Skips", "Fails", "WorksAfterwards", "Crashes", "Hangs/0", "WorksAtTheEnd"]
option, _, names = sys.argv[1].partition("=")
if option == "--gtest_list_tests":
    print("Running main() from gtest_main.cc", "Fake.", *("  " + test + "  # of a kind" for test in tests), sep="\\n")
    sys.exit()
assert option == "--gtest_filter"
for test in (test for test in tests if "Fake." + test in names.split(":")):
    print(f"[ RUN      ] Fake.{test}", flush=True)
    if test == "Crashes":
        os.kill(os.getpid(), signal.SIGKILL)
    if test == "Hangs/0":
        pathlib.Path(__file__).with_name("hanging").touch()
        time.sleep(1e6)
    word = {"Fails": "  FAILED  ", "Skips": "  SKIPPED "}.get(test, "       OK ")
    print(f"[{word}] Fake.{test}, where GetParam() = 1 (0 ms)", flush=True)
"""

# Answers cases as gpu_bench does. The mesh "holes" ends it, and "million" never ends.
FAKE_BENCH = """#!/usr/bin/env python3
import json, sys, time
print(json.dumps({"device": "fake", "driver": "none", "copy_bytes_per_second": 1, "cpu": "none", "threads": 1}), flush=True)
for line in sys.stdin:
    mesh = json.loads(line)["mesh"]
    if mesh == "holes":
        sys.exit(3)
    if mesh == "million":
        time.sleep(1e6)
    print(json.dumps({"error": "too large"}), flush=True)
"""


class InAFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        silence = contextlib.redirect_stdout(io.StringIO())
        self.output = silence.__enter__()
        self.addCleanup(silence.__exit__, None, None, None)

    def program(self, name, text):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        path.chmod(0o755)
        return str(path)


class RunSteps(InAFolder):
    def setUp(self):
        super().setUp()
        self.out = self.folder / "out"
        run.make_output(self.out)
        (self.folder / "bundle.txt").write_text("a fake\n")
        patch = unittest.mock.patch.object(run, "BUNDLE", self.folder)
        patch.start()
        self.addCleanup(patch.stop)

    def run_steps(self, commands, hangs=None, minutes=60):
        """Runs shell commands as steps. Only the step `hangs` exceeds its time, once it has made the file `hanging`."""
        steps = [run.Step(name, "", ["sh", "-c", command, "sh", "{folder}", "{seconds}"]) for name, command in commands.items()]

        class Process(subprocess.Popen):
            """A step that may take any time."""

            def __init__(self, command, **options):
                super().__init__(command, **options)
                folder = Path(options.get("cwd", ""))
                self.hanging = folder / "hanging" if hangs and folder.name == hangs else None

            def wait(self, timeout=None):
                if self.hanging is None:
                    return super().wait()
                while not self.hanging.exists():
                    time.sleep(0.01)
                self.hanging = None
                raise subprocess.TimeoutExpired(self.args, timeout)

        with unittest.mock.patch.object(subprocess, "Popen", Process):
            return run.run_steps(steps, steps, self.out, dict(os.environ), minutes)

    def rows(self):
        lines = [line.split(" | ") for line in (self.out / "summary.md").read_text().splitlines() if line.startswith("| ")]
        return [(line[0][2:], line[1]) for line in lines[1:]]

    def test_goes_on_after_steps_that_fail_or_hang(self):
        is_good = self.run_steps({"fails": "echo broken; exit 3", "dies": "kill -9 $$", "hangs": 'touch "$1/hanging"; sleep 1000000',
                                  "works": 'echo "$2" >"$1/seconds"'}, hangs="hangs")
        self.assertFalse(is_good)
        self.assertEqual(self.rows(), [("fails", "exit code 3"), ("dies", "exit code -9"), ("hangs", "ended after 480 s"),
                                       ("works", "exit code 0")])
        self.assertIn("    broken\n", self.output.getvalue())
        self.assertEqual((self.out / "fails/log.txt").read_text(), "broken\n")
        self.assertEqual((self.out / "works/seconds").read_text(), "420.0\n")
        with tarfile.open(self.out / "results.tar.gz") as archive:
            self.assertTrue({"out/summary.md", "out/fails/log.txt", "out/works/seconds"} <= set(archive.getnames()))

    def test_says_when_all_is_good(self):
        self.assertTrue(self.run_steps({"one": "true", "two": "true"}))

    def test_ends_what_a_step_has_started(self):
        os.mkfifo(self.folder / "alive")
        reader = os.open(self.folder / "alive", os.O_RDONLY | os.O_NONBLOCK)
        self.addCleanup(os.close, reader)
        command = f"""exec >'{self.folder}/alive'; sleep 1000000 & echo begun; touch "$1/hanging"; sleep 1000000"""
        self.run_steps({"hangs": command}, hangs="hangs")
        # The end comes when nobody has the other end any more, which is soon after the processes are killed.
        os.set_blocking(reader, True)
        with open(reader, "rb", closefd=False) as rest:
            self.assertEqual(rest.read(), b"begun\n")

    def test_divides_the_time_that_is_left(self):
        class StoppedClock:
            @staticmethod
            def monotonic():
                return 1000.0

        with unittest.mock.patch.object(run, "time", StoppedClock):
            self.assertTrue(self.run_steps({"one": 'echo "$2" >"$1/seconds"'}, minutes=4))
            self.assertEqual((self.out / "one/seconds").read_text(), "210.0\n")
            self.assertTrue(self.run_steps({"one": 'echo "$2" >"$1/seconds"'}, minutes=1 / 3))
            self.assertEqual((self.out / "one/seconds").read_text(), "17.5\n")
            self.assertFalse(self.run_steps({"two": "true"}, minutes=0.33))
        self.assertEqual(self.rows(), [("two", "not run")])

    def test_keeps_the_results_of_earlier_runs(self):
        self.run_steps({"one": "true", "two": "false"})
        self.run_steps({"two": "true", "one": "false"}, minutes=0)
        self.assertEqual(self.rows(), [("two", "exit code 1"), ("one", "exit code 0")])

    def test_replaces_no_foreign_files(self):
        (self.folder / "meshes").mkdir()
        with self.assertRaisesRegex(RuntimeError, "holds other files; name a new folder"):
            run.make_output(self.folder)
        self.run_steps({})
        run.make_output(self.out)

    def test_names_every_step_once(self):
        for is_quick in (False, True):
            names = [step.name for step in run.steps_of("vulkan:12", is_quick)]
            self.assertEqual(len(set(names)), len(names))

    def test_makes_every_table(self):
        for is_quick in (False, True):
            commands = [step.command for step in run.steps_of(None, is_quick)]
            made = {command[k + 1] for command in commands for k, word in enumerate(command) if word == "--table"}
            self.assertEqual(made, set(gpu_tables.tables_of(None, (), is_quick, None)))

    def test_runs_all_steps_on_the_device(self):
        with unittest.mock.patch.object(libraries, "choose", lambda *_: ["libraries"]):
            self.assertEqual(run.environment("vulkan:12", self.folder)["RAYMAP_VULKAN_DEVICE"], "12")
            self.assertNotIn("RAYMAP_VULKAN_DEVICE", run.environment(None, self.folder))
        for step in run.steps_of("vulkan:12", False):
            self.assertTrue("vulkan:12" in step.command or "_tests" in step.name, step)


class RunBundle(InAFolder):
    """Runs the bundle's run.sh, with programs that are none."""

    def setUp(self):
        super().setUp()
        for file in (ROOT / "bench/card").glob("*.*"):
            shutil.copy(file, self.folder)
        (self.folder / "bundle.txt").write_text("a fake\n")

    def run_bundle(self, *arguments):
        """Returns the exit code and the output."""
        ran = subprocess.run([self.folder / "run.sh", *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        return ran.returncode, ran.stdout.decode()

    def test_exit_codes(self):
        out = self.folder / "out"
        self.program("bin/raymap", "#!/bin/sh\necho $*\n")
        self.assertEqual(self.run_bundle(out, "--device", "vulkan:1", "devices")[0], 0)
        self.assertEqual((out / "devices/log.txt").read_text(), "devices --test vulkan:1\n")
        self.program("bin/raymap", "#!/bin/sh\nexit 9\n")
        self.assertEqual(self.run_bundle(out, "devices")[0], 1)
        self.assertIn("| devices | exit code 9 |", (out / "summary.md").read_text())

    def test_refuses_what_it_cannot_do(self):
        self.assertEqual(self.run_bundle()[0], 2)
        code, output = self.run_bundle(self.folder / "out", "device")
        self.assertEqual(code, 2)
        self.assertIn("there is no step 'device', only devices, vulkan_tests_1", output)
        (self.folder / "bin").mkdir()
        code, output = self.run_bundle(self.folder, "devices")
        self.assertEqual((code, output), (2, f"run.sh: {self.folder} holds other files; name a new folder\n"))
        (self.folder / "bin/raymap").write_text("not a program")
        code, output = self.run_bundle(self.folder / "out", "devices")
        self.assertEqual(code, 2)
        self.assertIn("Permission denied", output)

    def test_goes_on_when_the_terminal_is_gone(self):
        self.program("bin/raymap", "#!/bin/sh\nkill -HUP $PPID\n")
        reader, writer = os.pipe()
        os.close(reader)
        out = self.folder / "out"
        with open(writer, "wb") as gone:
            ran = subprocess.run([self.folder / "run.sh", out, "devices"], stdout=gone, stderr=subprocess.PIPE, check=False)
        self.assertEqual((ran.returncode, ran.stderr), (0, b""))
        self.assertIn("| devices | exit code 0 |", (out / "summary.md").read_text())

    def test_lists_its_steps(self):
        code, output = self.run_bundle("--list")
        self.assertEqual((code, output.splitlines()[0].split()[0]), (0, "devices"))


class RunGtest(InAFolder):
    def setUp(self):
        super().setUp()
        self.fake = self.program("tests", FAKE_TESTS)
        folder = self.folder

        class Lines(run_gtest.Lines):
            """Finds a hanging test when it hangs, however slow this machine is."""

            def next(self, seconds):
                while True:
                    try:
                        return super().next(0.01)
                    except queue.Empty:
                        if (folder / "hanging").exists():
                            (folder / "hanging").unlink()
                            raise

        patch = unittest.mock.patch.object(run_gtest, "Lines", Lines)
        patch.start()
        self.addCleanup(patch.stop)

    def test_runs_every_test_whatever_the_others_do(self):
        tests = run_gtest.tests_of(self.fake, ["*"], 1, 1)
        self.assertEqual(run_gtest.run(self.fake, tests, ENDLESS), {
            "Fake.Works": "OK", "Fake.Skips": "SKIPPED", "Fake.Fails": "FAILED", "Fake.WorksAfterwards": "OK",
            "Fake.Crashes": "CRASHED with exit code -9", "Fake.Hangs/0": "HUNG", "Fake.WorksAtTheEnd": "OK"})

    def test_splits_tests_into_parts(self):
        self.assertEqual(run_gtest.tests_of(self.fake, ["*Works*", "*ips"], 1, 2), ["Fake.Works", "Fake.WorksAfterwards"])
        self.assertEqual(run_gtest.tests_of(self.fake, ["*Works*", "*ips"], 2, 2), ["Fake.Skips", "Fake.WorksAtTheEnd"])

    def test_lists_what_no_time_was_left_for(self):
        self.assertEqual(run_gtest.run(self.fake, ["Fake.Works"], 0), {"Fake.Works": "NOT RUN, for no time was left"})

    def test_tells_a_crash_at_the_end(self):
        fake = self.program("crashes", "#!/bin/sh\necho '[ RUN      ] A.B'\necho '[       OK ] A.B (0 ms)'\nexit 139\n")
        self.assertEqual(run_gtest.run(fake, ["A.B"], ENDLESS), {"A.B": "OK", "after A.B": "CRASHED with exit code 139"})

    def run_main(self, *patterns):
        with unittest.mock.patch.object(sys, "argv", ["run_gtest.py", self.fake, *patterns, "--seconds", str(ENDLESS)]):
            with self.assertRaises(SystemExit) as end:
                run_gtest.main()
        return end.exception.code

    def test_exit_code(self):
        self.assertEqual(self.run_main("*Works*", "*Skips"), 0)
        self.assertIn("\n3 passed, 1 skipped, 0 failed\n", self.output.getvalue())
        self.assertEqual(self.run_main("*Fails", "*Works"), 1)
        self.assertIn("\n1 passed, 0 skipped, 1 failed\n  Fake.Fails: FAILED\n", self.output.getvalue())
        self.assertEqual(self.run_main("*NoSuch*"), 1)


class ChooseLibraries(InAFolder):
    """A program needs version V_2 of libfake.so.1. The system, here LD_LIBRARY_PATH, has it or not; `spare` has it."""

    def setUp(self):
        super().setUp()
        for version in ("V_1", "V_2"):
            self.compile("int f(void) { return 0; }", version, "-shared", "-fPIC", "-Wl,-soname,libfake.so.1",
                         f"-Wl,--version-script={self.program(version + '.map', version + ' { global: f; };')}")
        for name in ("bin", "lib", "spare", "chosen", "system"):
            (self.folder / name).mkdir()
        self.compile("int f(void); int main(void) { return f(); }", "bin/program", str(self.folder / "V_2"))
        (self.folder / "V_2").rename(self.folder / "spare/libfake.so.1")
        (self.folder / "bundle.txt").write_text("a fake\n")
        patch = unittest.mock.patch.dict(os.environ, {"LD_LIBRARY_PATH": str(self.folder / "system")})
        patch.start()
        self.addCleanup(patch.stop)

    def compile(self, code, name, *options):
        source = self.program(f"sources/{Path(name).name}.c", code)
        subprocess.run(["cc", source, "-o", self.folder / name, *options], check=True)

    def choose(self):
        """Returns the names of the spare libraries that are needed. Runs the program with what was chosen."""
        folders = libraries.choose(self.folder, self.folder / "chosen")
        path = libraries.search_path(folders)
        subprocess.run([self.folder / "bin/program"], env={"LD_LIBRARY_PATH": path}, check=True)
        return sorted(os.listdir(self.folder / "chosen"))

    def test_takes_a_spare_one_where_there_is_none(self):
        self.assertEqual(self.choose(), ["libfake.so.1"])

    def test_takes_a_spare_one_for_an_old_one(self):
        (self.folder / "V_1").rename(self.folder / "system/libfake.so.1")
        self.assertEqual(self.choose(), ["libfake.so.1"])

    def test_takes_the_system_s_where_it_serves(self):
        (self.folder / "spare/libfake.so.1").rename(self.folder / "system/libfake.so.1")
        self.assertEqual(self.choose(), [])

    def test_says_what_is_missing(self):
        (self.folder / "V_1").rename(self.folder / "system/libfake.so.1")
        (self.folder / "spare/libfake.so.1").unlink()
        with self.assertRaisesRegex(RuntimeError, "this system's libfake.so.1 is missing or too old for program"):
            self.choose()


class MeasureCases(InAFolder):
    def setUp(self):
        super().setUp()
        self.program("gpu_bench", FAKE_BENCH)
        self.log = io.StringIO()
        silence = contextlib.redirect_stderr(io.StringIO())
        silence.__enter__()
        self.addCleanup(silence.__exit__, None, None, None)

    def start(self):
        self.bench = gpu_program.Bench(str(self.folder / "gpu_bench"), None, self.log)

    def run_case(self, mesh):
        return self.bench.run("vulkan", mesh, 50, "cell+rays")

    def test_is_good_where_all_cases_are_answered(self):
        self.start()
        self.assertEqual(self.run_case("scan"), {"error": "too large"})
        self.assertTrue(self.bench.finish())

    def test_restarts_the_program(self):
        self.start()
        self.assertEqual(self.run_case("holes"), {"error": "gpu_bench ended with 3"})
        self.assertEqual(self.run_case("scan"), {"error": "too large"})
        self.assertFalse(self.bench.finish())
        self.assertEqual([json.loads(line)["mesh"] for line in self.log.getvalue().splitlines()], ["holes", "scan"])

    def test_ends_a_case_for_which_no_time_is_left(self):
        self.start()
        self.assertEqual(self.run_case("scan"), {"error": "too large"})
        self.bench.deadline = time.monotonic() + 0.2
        self.assertEqual(self.run_case("million"), {"error": gpu_program.NO_TIME})
        self.assertEqual(self.run_case("sphere"), {"error": gpu_program.NO_TIME})
        self.assertFalse(self.bench.finish())

    def tables(self, *options):
        """Returns the exit code and the tables of gpu_tables.py."""
        command = [sys.executable, ROOT / "bench/gpu_tables.py", self.folder / "gpu_bench", self.folder / "out", "--quick", *options]
        code = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False).returncode
        file = self.folder / "out/tables.md"
        return code, file.read_text() if file.exists() else ""

    def test_makes_the_tables_that_are_asked_for(self):
        self.assertEqual(self.tables("--table", "none"), (2, ""))
        code, text = self.tables("--table", "coarse")
        self.assertEqual(code, 0)
        self.assertIn("## A coarse grid for many triangles\n", text)
        self.assertNotIn("## Fields\n", text)

    def test_makes_tables_of_what_could_be_measured(self):
        code, text = self.tables("--table", "fields", "--table", "coarse")
        self.assertEqual(code, 1)
        self.assertIn("| scan | cell+rays | 24 | too large |", text)
        self.assertIn("| holes | exact+harmonic | 16 | gpu_bench ended with 3 |", text)
        self.assertIn("## A coarse grid for many triangles\n", text)


if __name__ == "__main__":
    unittest.main()
