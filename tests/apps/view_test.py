"""Tests the window of `raymap view` on a display in memory, with events as a mouse and a keyboard make them.

view_test.py RAYMAP: the program. Without Xvfb, xdotool or a Vulkan device, or if the program has no window, the test is
skipped (77), unless RAYMAP_REQUIRE_WINDOW is set."""

import contextlib
import json
import os
import pathlib
import shlex
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import zlib

import numpy as np
from moving_tube import bend, tumble
from x11_events import Display

RAYMAP = str(pathlib.Path(sys.argv.pop(1)).resolve()) if len(sys.argv) > 1 else None
SMALL = (260, 150)  # A device in software takes its time for every pixel.
BESIDE_PANEL = (520, 300)  # The mouse reaches the picture beside the panel, which lies over a part of it.
WIDE = (640, 480)  # The picture and the panel lie side by side.
BORDER = (127, 134, 143)  # Of boxes and of the mark of a picture that is not finished.
LONG = 240  # Seconds after which a test gives up; nothing is measured.


def read_png(path):
    """Returns the pixels of a PNG of 8 bits a colour, as (height, width, 3)."""
    data, at, packed = pathlib.Path(path).read_bytes(), 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", body[:10])
            assert (depth, colour) == (8, 2)
        if kind == b"IDAT":
            packed += body
        at += 12 + length
    rows = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, 1 + 3 * width)
    pixels = np.zeros((height, 3 * width), np.uint8)
    for y, row in enumerate(rows):
        above = pixels[y - 1] if y > 0 else np.zeros(3 * width, np.uint8)
        pixels[y] = unfiltered(row[0], row[1:], above)
    return pixels.reshape(height, width, 3)


def unfiltered(kind, row, above):
    if kind == 0:
        return row
    if kind == 2:
        return row + above
    result, up = row.tolist(), above.tolist()  # Plain integers are ten times as fast as those of NumPy.
    left, corner = [0, 0, 0], [0, 0, 0]
    for i, top in enumerate(up):
        a, c = left[i % 3], corner[i % 3]
        if kind == 1:
            guess = a
        elif kind == 3:
            guess = (a + top) // 2
        else:
            to_left, to_top, to_corner = abs(top - c), abs(a - c), abs(a + top - 2 * c)
            guess = a if to_left <= to_top and to_left <= to_corner else top if to_top <= to_corner else c
        result[i] = left[i % 3] = (result[i] + guess) % 256
        corner[i % 3] = top
    return np.array(result, np.uint8)


def differ(a, b):
    """Returns the mean difference of two pictures, and the share of pixels that differ by more than 8."""
    gaps = np.abs(a.astype(int) - b.astype(int))
    return gaps.mean(), (gaps.max(axis=2) > 8).mean()


def count_near(picture, colour):
    """Returns the number of pixels that have a colour but for rounding."""
    return (np.abs(picture.astype(int) - colour).max(axis=2) <= 2).sum()


def contrast(a, b):
    """Returns how many times more light one colour has than another, as the guidelines for web pages count it."""
    linear = [np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055)**2.4) for c in (np.asarray(a) / 255, np.asarray(b) / 255)]
    dark, light = sorted(colour @ (0.2126, 0.7152, 0.0722) for colour in linear)
    return (light + 0.05) / (dark + 0.05)


def vector_of(command, option):
    words = shlex.split(command)
    return np.array([float(part) for part in words[words.index(option) + 1].split(",")])


class Window:
    """A running `raymap view`, in a folder of its own."""

    def __init__(self, display, folder, *arguments, environment=None, size=SMALL):
        self.folder = folder
        self.display = Display(display)
        self.environment = {**os.environ, "DISPLAY": display, "RAYMAP_CACHE": "off",
                            "VK_INSTANCE_LAYERS": "VK_LAYER_KHRONOS_validation", **(environment or {})}
        self.out, self.err = folder / "out.txt", folder / "err.txt"
        command = [RAYMAP, "view", *arguments, "--size", *map(str, size)]
        with self.out.open("w") as out, self.err.open("w") as err:
            self.process = subprocess.Popen(command, cwd=folder, env=self.environment, stdout=out, stderr=err)
        self.id = self.until(self.find)
        self.tool("windowfocus", "--sync", self.id)

    def until(self, done):
        """Waits for a result that is not empty."""
        end = time.monotonic() + LONG
        while time.monotonic() < end:
            if result := done():
                return result
            if self.process.poll() is not None:
                raise AssertionError(f"it ended: {self.out.read_text()} {self.err.read_text()}")
            time.sleep(0.1)
        raise AssertionError(f"waited too long: {self.out.read_text()} {self.err.read_text()}")

    def find(self):
        return self.tool("search", "--pid", str(self.process.pid)).split("\n")[0]

    def tool(self, *words):
        done = subprocess.run(["xdotool", *map(str, words)], env=self.environment, text=True, capture_output=True)
        # A search that finds nothing fails, too.
        if done.returncode != 0 and words[0] != "search":
            raise AssertionError(f"xdotool {words}: {done.stderr}")
        return done.stdout

    def keys(self, *names):
        for name in names:
            self.tool("key", "--window", self.id, name)

    def drag(self, button, start, *way, modifier=None):
        held = ["keydown", modifier] if modifier else []
        moves = [word for place in way for word in ("mousemove", *place)]
        self.tool(*held, "mousemove", *start, "mousedown", button, *moves, "mouseup", button)
        if modifier:
            self.tool("keyup", modifier)

    def picture(self):
        """Returns what the window shows once it is as fine as it will be, and the command that draws it."""
        before = len(self.lines(0))
        self.keys("s")
        wrote, command = self.until(lambda: self.lines(before + 2))[before:]
        return read_png(self.folder / wrote.removeprefix("wrote ").split(",")[0]), command

    def shown(self):
        """Returns what the window shows now, panel included."""
        width, height = (int(line.split("=")[1]) for line in self.tool("getwindowgeometry", "--shell", self.id).split()[3:5])
        return self.display.pixels(int(self.id), width, height)

    def settled(self, before=None):
        """Returns what the window shows once that rests, and differs from before."""
        def same():
            first = self.shown()
            time.sleep(0.8)  # It draws at least once in a quarter of a second.
            rests = (first == self.shown()).all() and (before is None or (first != before).any())
            return [first] if rests else []
        return self.until(same)[0]

    def lines(self, count):
        lines = self.out.read_text().split("\n")[:-1]
        return lines if len(lines) >= count else None

    @contextlib.contextmanager
    def held(self):
        """Events wait until this ends."""
        self.process.send_signal(signal.SIGSTOP)
        yield
        self.process.send_signal(signal.SIGCONT)

    def drop(self, *paths):
        """Drops files on it. Returns whether it took them."""
        return self.display.drop(int(self.id), paths, LONG)

    def close(self):
        self.keys("q")
        try:
            code = self.process.wait(LONG)
        except subprocess.TimeoutExpired:
            raise AssertionError(f"it does not end: {self.out.read_text()} {self.err.read_text()}") from None
        self.display.close()
        return code, self.err.read_text()


class ViewTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        # It writes the number of its display to the pipe once one can connect. It would start again, and refuse
        # connections meanwhile, whenever the last one ends.
        ours, its = os.pipe()
        cls.server = subprocess.Popen(["Xvfb", "-noreset", "-displayfd", str(its), "-screen", "0", "1920x1080x24"],
                                      pass_fds=[its], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(its)
        with open(ours) as number:
            cls.display = ":" + number.readline().strip()
        cls.meshes = tempfile.TemporaryDirectory()
        for name, holes in ("globe.ply", []), ("holes.ply", ["--holes"]):
            subprocess.run([RAYMAP, "example", "-q", "-o", pathlib.Path(cls.meshes.name, name), *holes], check=True)

    @classmethod
    def tearDownClass(cls):
        cls.server.kill()
        cls.server.wait()
        cls.meshes.cleanup()

    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.scratch.name)
        self.mesh = self.folder / "globe.ply"
        self.example("globe.ply")
        self.window = None

    def tearDown(self):
        if self.window and self.window.process.poll() is None:
            self.window.process.kill()
            self.window.process.wait()
        self.scratch.cleanup()

    def example(self, name):
        """Replaces the mesh by globe.ply or holes.ply, at once as a program that saves it."""
        copy = shutil.copyfile(pathlib.Path(self.meshes.name, name), self.folder / "copy.ply")
        copy.replace(self.mesh)

    def recorder(self):
        """Returns the environment for a stand-in of ffmpeg, which keeps the pixels as they are. One can look at them in
        the file "recorded" while they come."""
        stand_in = self.folder / "bin" / "ffmpeg"
        stand_in.parent.mkdir()
        stand_in.write_text("#!/bin/sh\nexec tee recorded >&3\n")
        stand_in.chmod(0o755)
        return {"PATH": f"{stand_in.parent}:{os.environ['PATH']}"}

    def open(self, *arguments, **options):
        self.window = Window(self.display, self.folder, *arguments, **options)
        return self.window

    def close(self):
        code, errors = self.window.close()
        self.assertEqual((code, errors), (0, ""))  # The validation layers would write there.

    def rendered(self, command):
        """Returns the picture that the command draws."""
        words = shlex.split(command)
        output = self.folder / words[words.index("-o") + 1].replace("%d", words[words.index("--frames") + 1]
                                                                      if "--frames" in words else "")
        subprocess.run([RAYMAP, *words[1:], "--overwrite", "-q"], cwd=self.folder, check=True)
        return read_png(output)

    def check_as_render(self, picture, command):
        """The command draws the same picture."""
        mean, far = differ(picture, self.rendered(command))
        self.assertLess(mean, 0.1)  # What docs/cli.md says of any two devices.
        self.assertLess(far, 0.002)

    def test_shows_what_render_draws(self):
        window = self.open(self.mesh, "--resolution", "48", size=BESIDE_PANEL)
        first, command = window.picture()
        self.check_as_render(first, command)
        seen = [first]
        # Each of these changes the picture, and each picture is what `render` draws.
        for number, act in enumerate((lambda: window.drag(1, (400, 200), (450, 210), (500, 240)),
                                      lambda: window.drag(3, (400, 200), (430, 230)),
                                      lambda: window.tool("mousemove", 420, 200, "click", 4, "click", 4),
                                      lambda: window.keys("c"),
                                      lambda: window.drag(1, (400, 200), (370, 205), modifier="ctrl"),
                                      lambda: window.keys("x"),
                                      lambda: window.keys("3"),
                                      lambda: window.keys("f"))):
            act()
            picture, command = window.picture()
            with self.subTest(number):
                self.assertGreater(differ(picture, seen[-1])[1], 0.01)
                self.check_as_render(picture, command)
            seen.append(picture)
        self.close()

    def test_a_coarse_picture_has_no_stale_edges(self):
        window = self.open(self.mesh, "--resolution", "48", size=(520, 400))
        window.picture()
        window.keys("3", "s")
        gaps = []
        while not window.lines(4):
            shown = window.shown().astype(int)  # The shape is in the middle. Its ground hardly changes within three pixels.
            gaps += [np.abs(shown[:, -1] - shown[:, -4]).max(), np.abs(shown[-1, -100:] - shown[-4, -100:]).max()]
        self.assertGreater(len(gaps), 10)
        self.assertLess(max(gaps), 4)
        self.close()

    def test_lays_the_picture_beside_the_panel(self):
        for width, height in (WIDE, (1280, 800)):
            window = self.open(self.mesh, "--resolution", "24", size=(width, height))
            picture, command = window.picture()
            left = width - picture.shape[1]
            self.assertTrue(width / 5 < left < 0.6 * width, left)
            self.assertLess(differ(window.settled()[:, left:], picture)[1], 0.001)
            self.check_as_render(picture, command)
            # The shape is in the middle. To its right, the ground has a colour for each row.
            columns = np.flatnonzero((np.abs(picture.astype(int) - picture[:, -1:]).max(axis=2) > 60).any(axis=0))
            self.assertLess(abs(columns[0] + columns[-1] - picture.shape[1]), 0.1 * picture.shape[1])
            window.keys("p")
            self.assertEqual(window.picture()[0].shape, (height, width, 3))
            self.close()

    def test_finds_the_point_under_the_cursor_beside_the_panel(self):
        width, height = WIDE
        window = self.open(self.cube("cube.obj"), "--resolution", "24", "--iso", "0.01", size=WIDE)
        picture, command = window.picture()
        left = width - picture.shape[1]
        at = np.array([left + 180, 220])
        window.tool("mousemove", *at)
        window.settled()
        window.tool("click", "--repeat", 2, "--delay", 20, 1)
        moved = window.picture()[1]
        eye, forward, up = (vector_of(command, option) for option in ("--eye", "--direction", "--up"))
        # The camera turns around this point now, from as far away as before around the middle of the cube.
        way = vector_of(moved, "--eye") + np.linalg.norm(eye - 0.5) * forward - eye
        right = np.cross(forward, up) / np.linalg.norm(np.cross(forward, up))
        scale = height / (2 * np.tan(np.radians(15)) * (way @ forward))
        place = [left + picture.shape[1] / 2 + scale * (way @ right), height / 2 - scale * (way @ np.cross(right, forward))]
        np.testing.assert_allclose(place, at, atol=1.5)
        self.close()

    def test_help_fits_the_window(self):
        for size in ((320, 240), WIDE, (1280, 800), (1920, 1080)):
            with self.subTest(size):
                window = self.open(self.mesh, "--resolution", "24", size=size)
                window.tool("mousemove", 1, 1)  # Nothing is under the cursor.
                window.picture()
                before = window.settled()
                window.keys("h")
                after = window.settled(before)
                rows, columns = np.nonzero((before != after).any(axis=2))
                self.assertGreaterEqual(min(rows.min(), columns.min()), 4)
                self.assertLess(rows.max(), size[1] - 4)
                self.assertLess(columns.max(), size[0] - 4)
                if size[0] > 320:  # A smaller one has a bar to scroll. No text reaches the margin, where it would be cut off.
                    margin = after[rows.min() + 30:rows.max() - 5, columns.max() - 8:columns.max() - 2]
                    self.assertTrue((margin == margin[0, 0]).all())
                window.keys("h")
                self.assertTrue((window.settled(after) == before).all())
                self.close()

    def test_boxes_that_are_not_ticked_are_seen(self):
        window = self.open(self.mesh, "--resolution", "24", size=(640, 800))
        window.picture()
        before = window.settled()
        window.keys("m")
        rows, columns = np.nonzero((window.settled(before) != before).any(axis=2))  # The tick of "Measure".
        line = before[(rows.min() + rows.max()) // 2]
        ground = line[columns.min() - 25]
        self.assertGreater(max(contrast(colour, ground) for colour in line[columns.min() - 10:columns.min()]), 3)
        self.close()

    def test_text_has_the_scale_of_the_screen(self):
        widths = []
        for scale in (1, 2):
            root = Display(self.display)
            self.addCleanup(root.close)
            self.addCleanup(root.set_scale, 1)
            root.set_scale(scale)
            window = self.open(self.mesh, "--resolution", "24", size=WIDE)
            widths.append(window.picture()[0].shape[1])
            labels = window.settled()[:, 20 * scale:80 * scale].reshape(-1, 3).astype(int)
            greys = labels[np.ptp(labels, axis=1) < 16]
            self.assertGreater(len(np.unique(greys, axis=0)), 100)  # Edges of letters are smooth.
            self.close()
        self.assertEqual(widths[1], 2 * widths[0])

    def test_shows_what_colours_mean_and_that_a_picture_is_not_finished(self):
        window = self.open(self.mesh, "--resolution", "24", size=WIDE)
        picture = window.picture()[0]
        settled = window.settled()
        # A bar from the deepest colour inside to the deepest outside, with a dark line at 0.
        bars = [row for row in settled[:, :WIDE[0] - picture.shape[1]]
                if all(count_near(row[None], colour) for colour in ((38, 84, 148), (206, 104, 52), (28, 30, 34)))]
        self.assertGreater(len(bars), 5)
        corner = np.s_[:40, -120:]
        self.assertEqual(count_near(settled[corner], BORDER), 0)
        window.keys("3", "s")
        marks = []
        while not window.lines(4):
            marks.append(count_near(window.shown()[corner], BORDER))
        self.assertGreater(max(marks), 50)
        self.assertEqual(count_near(window.settled()[corner], BORDER), 0)
        self.close()

    def test_copies_a_view_and_takes_it_back(self):
        window = self.open(self.mesh, "--resolution", "32", size=BESIDE_PANEL)
        window.keys("x")
        first = window.picture()[0]
        with window.held():  # All comes in one frame, and is taken in its order.
            window.keys("ctrl+c")
            window.drag(1, (400, 200), (450, 210), (500, 240))
            window.keys("x")
        self.assertGreater(differ(window.picture()[0], first)[1], 0.01)
        window.keys("ctrl+v")
        self.assertLess(differ(window.picture()[0], first)[1], 0.001)
        self.close()

    def test_makes_fields_on_the_device_too(self):
        window = self.open(self.mesh, "--resolution", "40", "--device", "vulkan")
        picture, command = window.picture()
        self.check_as_render(picture, command)
        self.close()

    def test_shows_a_field_and_the_mesh_over_it(self):
        for mesh in self.mesh, self.cube("a.obj"):
            subprocess.run([RAYMAP, "generate", mesh, "-o", mesh.with_suffix(".vdb"), "--resolution", "40", "-q"], check=True)
        subprocess.run([RAYMAP, "convert", "a.vdb", self.mesh.with_suffix(".vdb").name, "-o", "both.vdb", "-q"],
                       cwd=self.folder, check=True)
        window = self.open(self.folder / "both.vdb", "--grid", "globe")
        picture, command = window.picture()
        self.assertIn(" --grid globe", command)
        self.check_as_render(picture, command)
        self.close()
        window = self.open(self.cube("cube.obj"), "--resolution", "40", "--iso", "-0.05")
        field = window.picture()[0]
        window.keys("w")
        edges = window.picture()[0]
        self.assertGreater(differ(edges, field)[1], 0.005)
        window.keys("w")
        faces = window.picture()[0]
        self.assertGreater(differ(faces, edges)[1], 0.05)
        self.close()

    def test_shows_a_narrow_band(self):
        band = self.folder / "band.vdb"  # All samples would take 32 GB.
        subprocess.run([RAYMAP, "generate", self.cube("a.obj"), "-o", band, "--voxel-size", "0.01", "--bounds",
                        "-10,-10,-10,10,10,10", "--band", "3", "-q"], check=True)
        window = self.open(band, "--direction", "-1,0.5,-0.7", size=BESIDE_PANEL)
        picture, command = window.picture()
        self.check_as_render(picture, command)
        window.keys("x")
        window.drag(1, (400, 200), (450, 210))
        sliced, command = window.picture()
        self.assertGreater(differ(sliced, picture)[1], 0.05)
        self.check_as_render(sliced, command)
        self.close()

    def cube(self, name, height=1):
        cube = self.folder / name
        corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n".replace(" 1\n", f" {height}\n")
        cube.write_text(corners + "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n")
        return cube

    def test_changes_between_two_shapes(self):
        low, high = self.cube("low.obj", 1), self.cube("high.obj", 1.4)
        subprocess.run([RAYMAP, "generate", high, "-o", self.folder / "high.vdb", "--resolution", "24", "-q"], check=True)
        for second, device in ((high, "cpu"), (high, "vulkan"), (self.folder / "high.vdb", "cpu")):
            with self.subTest(second=second.name, device=device):
                window = self.open(low, second, "--resolution", "28", "--range", "0.3", "--slice-plane", "0,1,0,0.6",
                                   "--device", device)
                difference, command = window.picture()  # The higher one is less far away: blue.
                self.assertEqual(shlex.split(command)[2:4], [str(low), str(second)])
                self.assertGreater((difference[..., 2] > difference[..., 0].astype(int) + 60).sum(), 125)
                self.check_as_render(difference, command)
                window.keys("b")
                other, command = window.picture()
                self.assertEqual(shlex.split(command)[2:4], [str(second), str(low)])
                self.assertGreater((other[..., 0] > other[..., 2].astype(int) + 60).sum(), 125)
                self.check_as_render(other, command)
                window.keys("v")
                distances, command = window.picture()
                self.assertIn("--as distance", command)
                self.assertGreater(differ(distances, other)[1], 0.05)
                self.check_as_render(distances, command)
                window.keys("b")
                self.check_as_render(*window.picture())
                self.close()

    def test_lays_the_other_mesh_over_a_shape(self):
        low, high = self.cube("low.obj", 1), self.cube("high.obj", 1.4)
        window = self.open(low, high, "--resolution", "28")
        window.keys("v")
        plain = window.picture()[0]
        window.keys("o")
        self.assertGreater(differ(window.picture()[0], plain)[1], 0.03)
        window.keys("b")  # Nothing of the lower one sticks out of the higher one, but for the field's round edges.
        inside = window.picture()[0]
        window.keys("o")
        self.assertLess(differ(window.picture()[0], inside)[1], 0.01)
        self.close()

    def test_shows_winding_numbers_and_confidences(self):
        cube = self.cube("cube.obj")
        subprocess.run([RAYMAP, "generate", cube, "-o", self.folder / "cube.vdb", "--resolution", "28", "--confidence",
                        self.folder / "c.npz", "-q"],
                       check=True)
        for shape, device, arrays in ((cube, "cpu", ["winding", "confidence", "distance"]),
                                      (cube, "vulkan", ["winding", "confidence", "distance"]),
                                      (self.folder / "cube.vdb", "cpu", ["confidence", "distance"])):
            with self.subTest(shape=shape.name, device=device):
                window = self.open(shape, "--resolution", "28", "--slice-plane", "1,1,0,0.9", "--device", device)
                seen = [window.picture()]
                for array in arrays:
                    window.keys("v")
                    picture, command = window.picture()
                    self.assertEqual("--as " + array in command, array != "distance")
                    self.assertGreater(differ(picture, seen[-1][0])[1], 0.02)
                    self.check_as_render(picture, command)
                    seen.append((picture, command))
                self.assertLess(differ(seen[0][0], seen[-1][0])[1], 0.001)
                window.keys("v", "ctrl+c")
                window.picture()
                window.keys("v")
                window.picture()
                window.keys("ctrl+v")
                self.assertLess(differ(window.picture()[0], seen[1][0])[1], 0.001)
                self.close()

    def info(self, mesh):
        done = subprocess.run([RAYMAP, "info", mesh, "--json"], text=True, capture_output=True)
        return json.loads(done.stdout)

    def test_shows_defects_and_goes_to_each(self):
        self.example("holes.ply")
        holes = self.info(self.mesh)["holes"]
        self.assertGreater(len(holes), 1)
        window = self.open(self.mesh, "--resolution", "40")
        self.assertEqual(count_near(window.picture()[0], (214, 30, 40)), 0)
        window.keys("d")
        self.assertGreater(count_near(window.picture()[0], (214, 30, 40)), 20)
        commands = []
        for key in ("n", "n", "ctrl+n"):
            window.keys(key)
            picture, command = window.picture()
            self.assertGreater(count_near(picture, (214, 30, 40)), 20)
            commands.append(command)
        self.assertEqual(commands[0], commands[2])
        for hole, command in zip(holes, commands[:2]):  # The camera looks at its middle, and the window shows all of it.
            eye, forward = vector_of(command, "--eye"), vector_of(command, "--direction")
            way = np.array(hole["centre"]) - eye
            depth = way @ forward
            self.assertLess(np.linalg.norm(way - depth * forward), 1e-5 * depth)
            shown = 2 * depth * np.tan(np.radians(15))
            self.assertGreater(shown, hole["diameter"])
            self.assertLess(shown, 9 * hole["diameter"])
        # A file without holes has none in colour.
        self.example("globe.ply")
        window.until(lambda: count_near(window.picture()[0], (214, 30, 40)) == 0)
        window.keys("n")
        window.picture()
        self.close()

    def test_shows_faces_that_are_wrong(self):
        corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
        spike = "v 0.7 0.7 0.5\nv 0.9 0.7 2\nv 0.7 0.9 2\nv 0.8 0.8 2.1\nf 9 11 10\nf 9 10 12\nf 10 11 12\nf 11 9 12\n"
        sides = "f 1 4 3\nf 1 3 2\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 2 3 7\nf 2 7 6\nf 3 4 8\nf 3 8 7\n"
        cube = self.folder / "cube.obj"
        # One of twelve faces points inwards, and a spike crosses the top.
        cube.write_text(corners + sides + "f 4 1 5\nf 5 4 8\n" + spike)
        for device in ("cpu", "vulkan"):  # On a device, faces are turned beforehand.
            with self.subTest(device):
                window = self.open(cube, "--resolution", "32", "--device", device, "--direction", "1,-0.6,-0.5")
                window.keys("w", "w", "d")
                picture = window.picture()[0].astype(int)
                red, green, blue = picture[..., 0], picture[..., 1], picture[..., 2]
                self.assertGreater(((blue > 2 * red) & (blue > 90)).sum(), 125)  # Flipped.
                self.assertGreater(((red > 4 * blue) & (red > 100) & (green > 1.3 * blue)).sum(), 125)  # Crossed.
                window.keys("d")
                picture = window.picture()[0].astype(int)
                self.assertEqual((picture[..., 2] > 2 * picture[..., 0]).sum(), 0)
                self.close()

    def test_follows_the_file_and_keeps_what_it_has_if_that_is_bad(self):
        window = self.open(self.mesh, "--resolution", "40")
        first = window.picture()[0]
        whole = self.mesh.read_bytes()
        self.mesh.write_bytes(whole[:len(whole) // 2])
        time.sleep(1.5)
        self.assertLess(differ(window.picture()[0], first)[1], 0.001)
        self.example("holes.ply")
        window.until(lambda: differ(window.picture()[0], first)[1] > 0.001)
        self.mesh.unlink()
        time.sleep(1.0)
        window.picture()
        self.close()

    def test_is_resized(self):
        window = self.open(self.mesh, "--resolution", "32")
        window.picture()
        window.tool("windowsize", "--sync", window.id, 300, 180)
        time.sleep(0.5)
        picture, command = window.picture()
        self.assertEqual(picture.shape, (180, 300, 3))
        self.check_as_render(picture, command)
        self.close()

    def test_shows_a_dropped_file(self):
        window = self.open(self.mesh, "--resolution", "32")
        first = window.picture()[0]
        self.assertTrue(window.drop(self.cube("a cube, 100 %.obj")))
        picture, command = window.picture()
        self.assertIn("a cube, 100 %.obj", command)
        self.assertGreater(differ(picture, first)[1], 0.05)
        self.check_as_render(picture, command)
        bad = self.folder / "bad.obj"
        bad.write_text("f 1 2 3\n")
        self.assertTrue(window.drop(bad))
        again, command = window.picture()
        self.assertIn("a cube, 100 %.obj", command)
        self.assertLess(differ(again, picture)[1], 0.001)
        self.assertTrue(window.drop(bad, self.mesh))  # Of several, the last stays.
        again, command = window.picture()
        self.assertIn("globe.ply", command)
        self.assertLess(differ(again, first)[1], 0.001)
        self.close()

    def test_records_each_frame(self):
        tube = self.folder / "tube.glb"
        bend(tube)
        width, height = 240, 180
        window = self.open(tube, "--resolution", "24", size=(width, height), environment=self.recorder())
        command = window.picture()[1]
        window.keys("r", "space")
        recorded, size = self.folder / "recorded", 3 * width * height

        def moving(path=recorded):
            """Returns the pictures from the last on that stands still, before the animation plays."""
            movie = np.fromfile(path, np.uint8) if path.exists() else np.zeros(0, np.uint8)
            pictures = movie[:len(movie) // size * size].reshape(-1, height, width, 3)
            moved = [(picture != pictures[0]).any() for picture in pictures]
            return pictures[moved.index(True) - 1:] if True in moved else []

        window.until(lambda: len(moving()) > 5)
        window.keys("r")
        window.until(lambda: window.lines(3))
        self.assertIn("wrote view_0001.mp4", window.out.read_text())
        movie = self.folder / "view_0001.mp4"
        self.assertEqual(movie.stat().st_size % size, 0)
        self.assertEqual(movie.read_bytes(), recorded.read_bytes())
        for frame in (0, 1, 5):
            with self.subTest(frame):
                one = command.replace("--fps 1000 --frames 0", f"--fps 24 --frames {frame}")
                self.check_as_render(moving(movie)[frame], one)
        self.close()

    def test_ends_a_record_with_the_window(self):
        window = self.open(self.mesh, "--resolution", "24", size=(120, 90), environment=self.recorder())
        window.keys("r")
        recorded = self.folder / "recorded"
        window.until(lambda: recorded.exists() and recorded.stat().st_size > 0)
        window.tool("windowsize", "--sync", window.id, 100, 80)  # A movie has pictures of one size.
        window.until(lambda: (self.folder / "view_0001.mp4").exists())
        self.assertEqual((self.folder / "view_0001.mp4").stat().st_size % (3 * 120 * 90), 0)
        window.keys("r")
        window.until(lambda: recorded.stat().st_size >= 2 * 3 * 100 * 80)
        self.close()
        self.assertEqual((self.folder / "view_0002.mp4").read_bytes(), recorded.read_bytes())

    def test_records_an_mp4(self):
        if not shutil.which("ffmpeg") or not shutil.which("ffprobe"):
            self.skipTest("ffmpeg is not installed")
        window = self.open(self.mesh, "--resolution", "24", size=(120, 90))
        window.keys("r")
        window.picture()
        window.keys("r")
        window.until(lambda: window.lines(3))
        self.close()
        count = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-select_streams", "v", "-show_entries",
                                "stream=nb_read_frames,width,height", "-of", "csv=p=0", "view_0001.mp4"], cwd=self.folder,
                               text=True, capture_output=True, check=True).stdout.split(",")
        self.assertEqual(count[:2], ["120", "90"])
        self.assertGreater(int(count[2]), 0)

    def test_rests_while_it_is_minimised(self):
        tube = self.folder / "tube.glb"
        bend(tube)
        window = self.open(tube, "--resolution", "24", size=(240, 180), environment=self.recorder())
        window.keys("r", "space")
        recorded = self.folder / "recorded"
        frames = lambda: recorded.stat().st_size if recorded.exists() else 0
        window.until(frames)
        window.display.minimise(int(window.id))

        def rests():
            before = frames()
            time.sleep(1.0)
            return frames() == before

        window.until(rests)
        before = frames()
        window.display.restore(int(window.id))
        window.until(lambda: frames() > before)
        window.tool("windowfocus", "--sync", window.id)
        window.keys("space", "r")
        window.until(lambda: window.lines(1))
        picture, command = window.picture()
        self.check_as_render(picture, command)
        self.close()

    def test_moves_the_grid_with_what_moves_rigidly(self):
        tube = self.folder / "tube.glb"
        tumble(tube)
        for device in ("cpu", "vulkan"):
            window = self.open(tube, "--resolution", "40", "--device", device, size=(350, 210))

            def stopped():
                """Returns the picture and the command of a moment at which the tube stands where it ends."""
                window.keys("space")
                time.sleep(0.3)
                window.keys("space")
                picture, command = window.picture()
                return (picture, command) if int(command.split("--frames ")[1].split()[0]) > 1000 else None

            picture, command = window.until(stopped)
            with self.subTest(device):
                # The samples of a grid that turned lie elsewhere. If the field were made anew, they would not.
                self.assertTrue(0.02 < differ(picture, self.rendered(command))[0] < 0.3)
                window.keys("x")  # A slice shows the edges of the grid, so the field is made anew.
                picture, command = window.picture()
                self.assertLess(differ(picture, self.rendered(command))[0], 0.02)
            self.close()

    def test_holds_no_more_memory_with_every_frame(self):
        tube = self.folder / "tube.glb"
        bend(tube)
        width, height = 64, 48
        window = self.open(tube, "--resolution", "16", size=(width, height),
                           environment={**self.recorder(), "VK_INSTANCE_LAYERS": ""})
        window.keys("space", "r")
        recorded = self.folder / "recorded"

        def memory(frames):
            """Returns kilobytes after so many frames, each with a field of its own. The system may take pages of files
            and of memory away, and bring them back: the former do not count, the latter wherever they are."""
            window.until(lambda: recorded.exists() and recorded.stat().st_size >= 3 * width * height * frames)
            status = pathlib.Path(f"/proc/{window.process.pid}/status").read_text()
            return sum(int(status.split(f"{name}:")[1].split()[0]) for name in ("RssAnon", "RssShmem", "VmSwap"))

        # A leak makes every part grow. Threads and the driver reserve memory in some parts only.
        most, held = 200, [memory(100)]  # 2 kB a frame; its picture alone has 9
        while len(held) < 15 and (len(held) == 1 or held[-1] - held[-2] >= most):
            held.append(memory(100 * (len(held) + 1)))
        self.assertLess(min(np.diff(held)), most, held)
        self.close()

    def test_says_why_there_is_no_window(self):
        for arguments, environment, code, text in (
                ([self.mesh], {"DISPLAY": ""}, 7, "a window cannot be opened"),
                ([self.folder / "none.ply"], {"DISPLAY": self.display}, 4, "none.ply"),
                ([self.mesh, "--device", "vulkan:77"], {"DISPLAY": self.display}, 2, "vulkan:77")):
            done = subprocess.run([RAYMAP, "view", *arguments], env={**os.environ, **environment}, text=True,
                                  capture_output=True, timeout=LONG)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertIn(text, done.stderr)


def reason_to_skip():
    for tool in ("Xvfb", "xdotool"):
        if not shutil.which(tool):
            return f"{tool} is not installed"
    probe = subprocess.run([RAYMAP, "view", __file__], text=True, capture_output=True)
    if "without a window" in probe.stderr:
        return "the program was built without a window"
    devices = subprocess.run([RAYMAP, "devices"], text=True, capture_output=True).stdout
    return "" if "vulkan:0" in devices else "there is no Vulkan device"


if __name__ == "__main__":
    reason = reason_to_skip()
    if reason and not os.environ.get("RAYMAP_REQUIRE_WINDOW"):
        print(f"skipped: {reason}")
        sys.exit(77)
    unittest.main(verbosity=2)
