"""Tests the pages that `raymap render` writes in Chromium, by WebDriver (https://www.w3.org/TR/webdriver2/).

page_test.py RAYMAP: the program. Without chromedriver, the test is skipped (77), unless RAYMAP_REQUIRE_BROWSER is set.
"""

import base64
import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.error
import urllib.request

RAYMAP = pathlib.Path(sys.argv.pop(1)) if len(sys.argv) > 1 else None
SIZE = (160, 120)
FLAGS = ["--headless=new", "--no-sandbox", "--hide-scrollbars", "--force-device-scale-factor=1", "--disable-dev-shm-usage"]
SOFTWARE = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
ELEMENT = "element-6066-11e4-a52e-4f735466cecf"

# Draws a picture beside the canvas and returns the mean difference of its colours and the share of pixels that differ by
# more than 8.
COMPARE = """
const [source, done] = arguments, image = new Image(), canvas = document.getElementById("canvas");
image.onload = () => {
  const pixels = drawn => {
    const context = Object.assign(document.createElement("canvas"), { width: image.width, height: image.height })
      .getContext("2d");
    context.drawImage(drawn, 0, 0);
    return context.getImageData(0, 0, image.width, image.height).data;
  };
  const a = pixels(image), b = pixels(canvas);
  let total = 0, far = 0;
  for (let i = 0; i < a.length; i += 4) {
    const gaps = [0, 1, 2].map(c => Math.abs(a[i + c] - b[i + c]));
    total += gaps[0] + gaps[1] + gaps[2];
    far += Math.max(...gaps) > 8;
  }
  done([canvas.width, canvas.height, total / (a.length * 0.75), far / (a.length / 4)]);
};
image.src = source;
"""


# Moves the mouse over a lattice of points of the canvas. Returns what the page says of each, and the colour there.
READ_OFF = """
const canvas = document.getElementById("canvas"), box = canvas.getBoundingClientRect(), place = document.getElementById("place");
const copy = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height }).getContext("2d");
copy.drawImage(canvas, 0, 0);
const found = [];
for (let y = 5; y < canvas.height; y += 10)
  for (let x = 5; x < canvas.width; x += 10) {
    canvas.dispatchEvent(new PointerEvent("pointermove", { clientX: box.left + x, clientY: box.top + y }));
    found.push([place.textContent, ...copy.getImageData(x, y, 1, 1).data]);
  }
return found;
"""


# Presses the key F on a page, and returns the colours of the right column and the top row of what it draws first.
COARSE_EDGES = """
const done = arguments[0], canvas = document.getElementById("canvas"), { width, height } = canvas;
document.dispatchEvent(new KeyboardEvent("keydown", { key: "f", bubbles: true }));
requestAnimationFrame(() => requestAnimationFrame(() => {
  const copy = Object.assign(document.createElement("canvas"), { width, height }).getContext("2d");
  copy.drawImage(canvas, 0, 0);
  done([document.body.dataset.drawn, ...copy.getImageData(width - 1, 0, 1, height).data, ...copy.getImageData(0, 0, width, 1).data]);
}));
"""


def colour_at(stops, value):
    """Returns the colour of a value as the page mixes it, 0 to 255."""
    colour = stops[0][1:]
    for (low, *_), (high, *following) in zip(stops, stops[1:]):
        share = min(max((value - low) / (high - low), 0), 1)
        colour = [a + share * (b - a) for a, b in zip(colour, following)]
    return [255 * (12.92 * c if c <= 0.0031308 else 1.055 * c ** (1 / 2.4) - 0.055) for c in colour]


class Browser:
    """A Chromium that shows a page."""

    def __init__(self, port, flags):
        self.base = f"http://127.0.0.1:{port}/session"
        wanted = {"goog:chromeOptions": {"args": [*FLAGS, *flags]},
                  "goog:loggingPrefs": {"browser": "ALL"}}
        self.base += "/" + self.post("", {"capabilities": {"alwaysMatch": wanted}})["sessionId"]

    def request(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.base + path, data, {"Content-Type": "application/json"}, method=method)
        try:
            with urllib.request.urlopen(request, timeout=300) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise AssertionError(error.read().decode()) from error

    def post(self, path, body):
        return self.request("POST", path, body)

    def open(self, page, width, height):
        self.post("/timeouts", {"script": 300000, "pageLoad": 300000})
        self.request("DELETE", "/actions")  # The mouse is where it was at first.
        self.post("/window/rect", {"width": width, "height": height})
        self.post("/url", {"url": page.as_uri()})

    def run(self, script, *arguments):
        return self.post("/execute/sync", {"script": script, "args": list(arguments)})

    def run_async(self, script, *arguments):
        return self.post("/execute/async", {"script": script, "args": list(arguments)})

    def wait(self):
        """Waits until the page has drawn all that it was told."""
        self.run_async("""const done = arguments[0];
          const look = () => document.body.dataset.drawn === "yes" ? done() : setTimeout(look, 20);
          setTimeout(look, 50);""")

    def canvas(self):
        """Returns a digest of what the canvas shows."""
        shown = self.run("return document.getElementById('canvas').toDataURL()")
        return hashlib.sha256(shown.encode()).hexdigest()

    def act(self, kind, *actions, **more):
        self.post("/actions", {"actions": [{"type": kind, "id": kind, "actions": list(actions), **more}]})
        self.wait()

    def drag(self, x, y, button=0):
        canvas = self.post("/element", {"using": "css selector", "value": "#canvas"})
        self.act("pointer", {"type": "pointerMove", "origin": canvas, "x": 0, "y": 0},
                 {"type": "pointerDown", "button": button},
                 {"type": "pointerMove", "origin": "pointer", "duration": 50, "x": x, "y": y},
                 {"type": "pointerUp", "button": button})

    def press(self, key):
        self.act("key", {"type": "keyDown", "value": key}, {"type": "keyUp", "value": key})

    def set(self, name, value):
        """Sets a control as a user would, with its events."""
        self.run("""const [name, value] = arguments, input = document.getElementById(name);
          if (input.type === "checkbox") input.checked = value; else input.value = value;
          input.dispatchEvent(new Event("input", { bubbles: true }));""", name, value)
        self.wait()

    def errors(self):
        return [entry["message"] for entry in self.post("/se/log", {"type": "browser"}) if entry["level"] == "SEVERE"]

    def close(self):
        self.request("DELETE", "")


class Page(unittest.TestCase):
    browser = None

    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        cls.raymap("example", "-o", "mesh.ply")
        cls.raymap("generate", "mesh.ply", "-o", "field.nrrd", "--resolution", "48")
        cls.raymap("example", "-o", "holed.ply", "--holes")
        driver = subprocess.Popen(["chromedriver", "--port=0"], stdout=subprocess.PIPE, text=True)
        cls.addClassCleanup(driver.stdout.close)
        cls.addClassCleanup(driver.wait)
        cls.addClassCleanup(driver.kill)
        for line in driver.stdout:
            if found := re.search(r"started successfully on port (\d+)", line):
                cls.port = int(found[1])
                break

    @classmethod
    def raymap(cls, *arguments):
        subprocess.run([RAYMAP, "-q", *arguments], cwd=cls.folder, check=True)
        return cls.folder / arguments[arguments.index("-o") + 1]

    def page(self, *options):
        return self.raymap("render", "field.nrrd", "-o", f"{self.id()}.html", "--size", *map(str, SIZE), *options)

    def picture(self, *options):
        return self.raymap("render", "field.nrrd", "-o", f"{self.id()}.png", "--device", "cpu", "--size",
                           *map(str, SIZE), *options)

    def start(self, flags):
        browser = Browser(self.port, flags)
        self.addClassCleanup(browser.close)
        return browser

    def browse(self, page, width=900, height=700):
        """Returns the browser of all tests, which shows the page: it compiles the shader once."""
        if Page.browser is None:
            Page.browser = self.start(SOFTWARE)
        self.browser.open(page, width, height)
        return self.browser

    def canvas(self, page):
        """Returns a browser that shows the page's canvas in the pictures' size."""
        browser = self.browse(page, width=500, height=440)
        browser.run("""const style = document.getElementById("canvas").style;
          [style.width, style.height] = [arguments[0] + "px", arguments[1] + "px"];""", *SIZE)
        browser.run_async("requestAnimationFrame(() => requestAnimationFrame(arguments[0]))")
        browser.wait()
        return browser

    def assertShows(self, browser, picture):
        source = "data:image/png;base64," + base64.b64encode(picture.read_bytes()).decode()
        width, height, mean, far = browser.run_async(COMPARE, source)
        self.assertEqual((width, height), SIZE)
        self.assertLess(mean, 0.5)
        self.assertLess(far, 0.01)

    def test_shows_what_render_draws(self):
        browser = self.canvas(self.page())
        self.assertShows(browser, self.picture())
        with self.assertRaises(AssertionError):  # The tolerance tells other pictures apart.
            self.assertShows(browser, self.picture("--cut"))
        self.assertEqual(browser.errors(), [])

    def test_begins_with_the_cut_and_the_shell(self):
        browser = self.canvas(self.page("--cut", "--shell", "0.1"))
        self.assertShows(browser, self.picture("--cut", "--shell", "0.1"))

    def test_turns_moves_and_zooms(self):
        browser = self.canvas(self.page())
        first = browser.canvas()
        browser.act("pointer", {"type": "pointerMove", "x": 5, "y": 5})
        seen = {first}
        for action in (lambda: browser.drag(60, 20), lambda: browser.drag(40, 0, button=2),
                       lambda: browser.press("+"), lambda: browser.press("7"), lambda: browser.press("\ue012"),
                       lambda: browser.post("/actions", {"actions": [{"type": "wheel", "id": "wheel", "actions": [
                           {"type": "scroll", "x": 120, "y": 90, "deltaX": 0, "deltaY": -300}]}]}) or browser.wait()):
            action()
            self.assertNotIn(browser.canvas(), seen)
            seen.add(browser.canvas())
        browser.press("f")
        self.assertEqual(browser.canvas(), first)
        self.assertEqual(browser.errors(), [])

    def test_obeys_its_controls(self):
        browser = self.canvas(self.page())
        first = browser.canvas()
        seen = {first}
        for name, value in (("cut", "x"), ("cutAt", 0.4), ("shell", 0.6), ("flip", True), ("iso", 1), ("slice", "z"),
                            ("sliceAt", 0.7)):
            browser.set(name, value)
            self.assertNotIn(browser.canvas(), seen, name)
            seen.add(browser.canvas())
        browser.run("document.getElementById('controls').reset()")
        browser.wait()
        self.assertEqual(browser.canvas(), first)

    def test_a_coarse_picture_has_no_stale_edges(self):
        browser = self.canvas(self.page())
        browser.run("""for (let i = 0; i < 14; ++i)  // The shape, which is brown, fills the canvas.
          document.dispatchEvent(new KeyboardEvent("keydown", { key: "+" }));""")
        browser.wait()
        drawn, *edges = browser.run_async(COARSE_EDGES)
        self.assertEqual(drawn, "no")
        ground = [(red, blue) for red, blue in zip(edges[::4], edges[2::4])]
        self.assertEqual(len(ground), sum(SIZE))
        self.assertEqual([(red, blue) for red, blue in ground if red > blue], [])  # The ground is white to blue.

    def legend(self, browser):
        """Returns the texts of the colour bar, and the shares of its width at which its marks stand."""
        return browser.run("""const marks = [...document.querySelectorAll("#levels span")];
          const texts = ["least", "leastSide", "mostSide", "most", "meaning"].map(id => document.getElementById(id).textContent);
          return [texts, marks.map(mark => mark.textContent), marks.map(mark => parseFloat(mark.style.left) / 100)];""")

    def test_marks_zero_inside_and_outside_on_the_colour_bar(self):
        browser, data = self.of_mesh("--cut")
        (least, *sides, most, meaning), marks, places = self.legend(browser)
        self.assertEqual((sides, marks, meaning), (["inside", "outside"], ["0"], ""))
        self.assertAlmostEqual(places[0], float(least) / (float(least) - float(most)), delta=1e-3)
        browser.set("cut", "")
        self.assertEqual(self.legend(browser)[0][-1], "A cut or a slice shows these colours.")
        browser.set("slice", "y")
        self.assertEqual(self.legend(browser)[0][-1], "")
        browser.set("colours", 1)  # Winding numbers, from below 0.5 to above.
        (_, *sides, _, _), marks, places = self.legend(browser)
        self.assertEqual((sides, marks), (["outside", "inside"], ["0.5"]))
        browser.set("colours", 2)  # Confidences colour the surface too.
        browser.set("slice", "")
        (_, *sides, _, meaning), marks, _ = self.legend(browser)
        self.assertEqual((sides, marks, meaning), (["", ""], [], ""))

    def test_marks_a_picture_that_is_still_refining(self):
        browser = self.canvas(self.page())
        look = """document.body.dataset.drawn = arguments[0];
          const busy = document.getElementById("busy");
          busy.style.transition = "none";
          return [getComputedStyle(busy).visibility, busy.textContent, busy.style.getPropertyValue("--share") > 0.96];"""
        self.assertEqual(browser.run(look, "yes"), ["hidden", "refining", True])
        self.assertEqual(browser.run(look, "no"), ["visible", "refining", True])

    def test_figures_have_four_digits(self):
        self.raymap("convert", "field.nrrd", "-o", "far.nrrd", "--translate", "100000.03", "0.123456789", "0")
        page = self.raymap("render", "far.nrrd", "-o", "far_away.html", "--size", "64", "48")
        rows = dict(re.findall("<th>(.*?)</th><td>(.*?)</td>", page.read_text()))
        for name in ("Spacing", "Distances", "Inside"):
            for figure in re.findall(r"[\d.]+", rows[name]):
                self.assertLessEqual(len(figure.replace(".", "").lstrip("0")), 4, (name, rows[name]))
        origin = [float(value) for value in rows["Origin"].split(", ")]  # In steps of 0.001, as the box is 5 across.
        for value in origin:
            self.assertRegex(str(value), r"^-?\d+(\.\d{1,3})?$")
        self.assertTrue(99990 < origin[0] < 100000, origin)
        browser = self.canvas(page)
        for text, *_ in browser.run(READ_OFF):
            for value in re.findall(r"[\d.e-]+", text.partition(")")[0]):
                self.assertRegex(value, r"^-?\d+(\.\d{1,3})?$")

    def test_reads_off_positions_and_distances(self):
        browser = self.canvas(self.page())
        browser.set("slice", "z")
        canvas = browser.post("/element", {"using": "css selector", "value": "#canvas"})
        browser.act("pointer", {"type": "pointerMove", "origin": canvas, "x": 0, "y": 0})
        text = browser.run("return document.getElementById('place').textContent")
        self.assertRegex(text, r"^\(-?[\d.e-]+, -?[\d.e-]+, -?[\d.e-]+\)")

    def test_fits_phones_and_large_screens(self):
        page = self.page()
        for width in (390, 1024, 1920):
            browser = self.browse(page, width=width, height=300)
            browser.wait()
            inner, scroll, canvas = browser.run("""return [innerWidth, document.documentElement.scrollWidth,
              document.getElementById("canvas").clientWidth]""")
            self.assertLessEqual(scroll, inner)
            self.assertGreater(canvas, 0.5 * inner)

    def test_shows_a_picture_without_webgl(self):
        browser = self.start(["--disable-3d-apis"])
        browser.open(self.page(), 900, 700)
        browser.run_async("""const done = arguments[0], look = () =>
          document.getElementById("trouble").hidden ? setTimeout(look, 20) : done();
          look();""")
        still, canvas, width, text = browser.run("""const id = name => document.getElementById(name);
          return [id("still").hidden, id("canvas").hidden, id("still").naturalWidth, document.body.innerText]""")
        self.assertEqual((still, canvas, width), (False, True, SIZE[0]))
        self.assertIn("Only a picture: this browser has no WebGL 2.", text)
        self.assertIn("Spacing", text)

    def of_mesh(self, *options):
        """Returns a browser with the page of a mesh with holes, and the page's data."""
        page = self.raymap("render", "holed.ply", "-o", f"{self.id()}.html", "--resolution", "32", "--size",
                           *map(str, SIZE), *options)
        return self.canvas(page), json.loads(re.search(r'id="page">(.*?)</script>', page.read_text())[1])

    def assertColours(self, browser, name, stops, unit=1.0):
        """Checks that what the mouse reads off has the page's colours, but for lines."""
        matches = []
        for text, *colour in browser.run(READ_OFF):
            if value := re.search(rf"\b{name} (-?[\d.e-]+)", text):
                wanted = colour_at(stops, float(value[1]) / unit)
                matches.append(max(abs(a - b) for a, b in zip(colour, wanted)) < 12)
        self.assertGreater(len(matches), 40)
        self.assertGreater(sum(matches) / len(matches), 0.6)

    def test_shows_winding_numbers_and_confidences(self):
        browser, data = self.of_mesh()
        first = browser.canvas()
        browser.set("colours", 1)
        self.assertEqual(browser.canvas(), first)  # Winding numbers do not colour the surface.
        browser.set("colours", 2)
        self.assertNotEqual(browser.canvas(), first)
        browser.set("slice", "z")
        browser.set("sliceAt", 0)  # Nothing is before it.
        browser.press("1")
        self.assertColours(browser, "confidence", data["arrays"][2]["stops"])
        browser.set("colours", 1)
        self.assertColours(browser, "winding number", data["arrays"][1]["stops"])
        browser.set("colours", 0)
        self.assertColours(browser, "distance", data["arrays"][0]["stops"], data["spacing"])
        self.assertEqual(browser.errors(), [])

    def test_cuts_show_the_chosen_array(self):
        browser, _ = self.of_mesh("--cut")
        seen = {browser.canvas()}
        for colours in (1, 2):
            browser.set("colours", colours)
            self.assertNotIn(browser.canvas(), seen)
            seen.add(browser.canvas())

    def test_begins_with_the_colours_of_an_array(self):
        browser, _ = self.of_mesh("--as", "confidence")
        first = browser.canvas()
        self.assertEqual(browser.run("return document.getElementById('colours').value"), "2")
        browser.set("colours", 0)
        self.assertNotEqual(browser.canvas(), first)

    def test_lists_defects_and_leads_there(self):
        browser, data = self.of_mesh()
        first = browser.canvas()
        found = json.loads(subprocess.run([RAYMAP, "info", "--json", "holed.ply"], cwd=self.folder, check=True,
                                          capture_output=True).stdout)
        holes = data["defects"][0]
        self.assertEqual((holes["name"], holes["places"], holes["count"]),
                         ("Holes", len(found["holes"]), found["boundary_edges"]))
        summary, details = [browser.post("/element", {"using": "css selector", "value": "#defects " + which})[ELEMENT]
                            for which in ("summary", "details")]
        self.assertEqual(browser.request("GET", f"/element/{summary}/text"), f"Holes: {holes['places']}")
        browser.post(f"/element/{summary}/click", {})
        buttons = browser.post(f"/element/{details}/elements", {"using": "css selector", "value": "button"})
        self.assertEqual(len(buttons), min(holes["places"], 100))
        # They look like what one can click, and the list ends in whole lines wherever it is scrolled to.
        height, row, cursor, sign, snap = browser.run("""const list = document.querySelector("#defects ol");
          const [item, button] = ["li", "button"].map(kind => list.querySelector(kind));
          list.scrollTop = 0.4 * item.offsetHeight;
          return [list.clientHeight, item.offsetHeight, getComputedStyle(button).cursor,
            getComputedStyle(button, "::after").content, getComputedStyle(list).scrollSnapType];""")
        self.assertEqual((height % row, cursor, sign, snap), (0, "pointer", '"›"', "y mandatory"))
        self.assertGreater(len(buttons), height // row)
        seen = {first}
        for button in buttons[:2]:
            browser.post(f"/element/{button[ELEMENT]}/click", {})
            browser.wait()
            self.assertNotIn(browser.canvas(), seen)
            seen.add(browser.canvas())
            self.assertEqual(self.mark(browser), [SIZE[0] / 2, SIZE[1] / 2])
            self.assertIn("rgb", browser.run("return getComputedStyle(document.querySelector('#defects .shown')).color"))
        browser.drag(20, 0, button=2)
        x, y = self.mark(browser)
        self.assertAlmostEqual(x, SIZE[0] / 2 + 20, delta=1)
        self.assertAlmostEqual(y, SIZE[1] / 2, delta=1)
        browser.run("document.activeElement.blur()")
        browser.press("f")
        self.assertIsNone(self.mark(browser))
        self.assertEqual(browser.canvas(), first)
        self.assertEqual(browser.errors(), [])

    def mark(self, browser):
        """Returns where the mark's centre is on the canvas, or None."""
        return browser.run("""const mark = document.getElementById("mark");
          return mark.hidden ? null : [mark.offsetLeft, mark.offsetTop];""")

    def test_says_how_many_defects_it_leaves_out(self):
        corners = [(i + dx, dy, 0) for i in range(0, 240, 2) for dx, dy in ((0, 0), (1, 0), (0, 1))]
        (self.folder / "leaves.obj").write_text("".join(f"v {x} {y} {z}\n" for x, y, z in corners) + "".join(
            f"f {i} {i + 1} {i + 2}\n" for i in range(1, len(corners), 3)))
        page = self.raymap("render", "leaves.obj", "-o", "leaves.html", "--resolution", "32", "--size", "64", "48")
        browser = self.canvas(page)
        text = browser.run("return document.querySelector('#defects details').textContent")
        self.assertTrue(text.startswith("Holes: 120The 100 largest of 120 places:"), text[:80])

    def test_a_field_has_no_list_of_defects(self):
        self.assertTrue(self.canvas(self.page()).run("return document.getElementById('defects').hidden"))

    def test_compares_two_fields(self):
        self.raymap("convert", "field.nrrd", "-o", "moved.nrrd", "--translate", "0.1", "0.05", "0")
        written = subprocess.run([RAYMAP, "render", "field.nrrd", "moved.nrrd", "-o", "two.html", "--size",
                                  *map(str, SIZE)], cwd=self.folder, check=True, capture_output=True, text=True).stdout
        self.assertIn("it shows moved.nrrd on the grid of field.nrrd", written)
        page = self.folder / "two.html"
        data = json.loads(re.search(r'id="page">(.*?)</script>', page.read_text())[1])
        browser = self.canvas(page)
        self.assertShows(browser, self.picture())
        first = browser.canvas()
        browser.press("b")
        other = browser.canvas()
        self.assertNotEqual(other, first)
        browser.set("field", 0)
        self.assertEqual(browser.canvas(), first)
        browser.set("colours", 1)
        coloured = browser.canvas()
        self.assertNotEqual(coloured, first)
        browser.set("range", 0.3)
        self.assertNotEqual(browser.canvas(), coloured)
        least, most = browser.run("return ['least', 'most'].map(id => Number(document.getElementById(id).textContent))")
        self.assertGreater(most, 0.01)
        self.assertEqual(least, -most)
        browser.set("slice", "z")
        browser.set("sliceAt", 0)
        browser.press("1")
        self.assertColours(browser, "B − A", [[at * most, *colour] for at, *colour in data["difference"]])
        gaps = []
        for text, *_ in browser.run(READ_OFF):
            if "B − A" in text:
                a, b, gap = [float(value) for value in re.findall(r"[AB] (-?[\d.e-]+)", text)]
                self.assertAlmostEqual(b - a, gap, delta=2e-3 * max(abs(a), abs(b)))
                gaps.append(abs(gap))
        self.assertGreater(max(gaps), 0.05)
        self.assertLess(max(gaps), 0.1121)
        self.assertEqual(browser.errors(), [])

    def test_shows_two_meshes_on_a_grid_over_both(self):
        self.raymap("convert", "mesh.ply", "-o", "far.ply", "--translate", "3", "0", "0")
        page = self.raymap("render", "mesh.ply", "far.ply", "-o", "far.html", "--resolution", "32", "--size", "64", "48")
        browser = self.canvas(page)
        browser.press("b")
        x = [float(found[1]) for text, *_ in browser.run(READ_OFF) if (found := re.match(r"\((-?[\d.e-]+)", text))]
        self.assertGreater(len(x), 10)
        self.assertGreater(min(x), 1.5)

    def test_refuses_arrays_and_maps_of_two_fields(self):
        for output, *options in (["two.png", "--slice", "z"], ["two.html", "--as", "winding"], ["two.html", "--slice", "z"]):
            done = subprocess.run([RAYMAP, "render", "field.nrrd", "field.nrrd", "-o", output, *options],
                                  cwd=self.folder, capture_output=True, text=True)
            self.assertEqual(done.returncode, 2, done.stderr)

    def test_shows_larger_fields_on_a_coarser_grid(self):
        page = self.page("--max-size", "24")
        dims = json.loads(re.search(r'id="page">(.*?)</script>', page.read_text())[1])["dims"]
        self.assertEqual(max(dims), 24)
        self.assertIn("In this page", page.read_text())
        self.canvas(page)  # It draws.

    def test_escapes_its_title(self):
        shutil.copy(self.folder / "field.nrrd", self.folder / "<b>&.nrrd")
        page = self.raymap("render", "<b>&.nrrd", "-o", "title.html", "--size", "64", "48")
        self.assertIn("<title>&lt;b&gt;&amp;.nrrd</title>".replace("&gt;", ">"), page.read_text())


if __name__ == "__main__":
    if not shutil.which("chromedriver") and "RAYMAP_REQUIRE_BROWSER" not in os.environ:
        print("no chromedriver")
        sys.exit(77)
    unittest.main()
