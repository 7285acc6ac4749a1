"""A source tree in which the tests of scripts/check_*.py and scripts/records.py plant faults."""

import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


class PlantedTree(unittest.TestCase):
    """Tests a script on the tree `root`, a temporary folder, which is empty at first."""

    script = ""  # Its name in scripts/.
    options = ()

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)

    def copy(self, *names):
        """Copies folders and files of the project."""
        for name in names:
            if (ROOT / name).is_dir():
                shutil.copytree(ROOT / name, self.root / name, dirs_exist_ok=True)
            else:
                self.put(name, (ROOT / name).read_text())

    def put(self, name, text):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)

    def edit(self, name, old, new):
        """Replaces the first place of a text, which must be there."""
        text = (self.root / name).read_text()
        self.assertIn(old, text)
        self.put(name, text.replace(old, new, 1))

    def output(self, code):
        """Runs the script, which must end with this exit code. Returns what it prints."""
        run = subprocess.run([sys.executable, ROOT / "scripts" / self.script, *self.options, self.root], capture_output=True,
                             text=True)
        self.assertEqual(run.returncode, code, run.stdout + run.stderr)
        return run.stdout + run.stderr

    def assert_accepted(self, text=""):
        """Checks that the script accepts the tree, and prints the text."""
        self.assertIn(text, self.output(0))

    def assert_found(self, *texts):
        """Checks that the script finds faults, and prints each of the texts. Returns the lines that it prints."""
        output = self.output(1)
        for text in texts:
            self.assertIn(text, output)
        return output.splitlines()
