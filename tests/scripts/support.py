"""Shared by the tests of the scripts."""

import importlib.util
import os
import pathlib
import pty
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

PROJECT = pathlib.Path(__file__).resolve().parents[2]
SCRIPTS = PROJECT / "scripts"
DATA = PROJECT / "data"
PROGRAM = pathlib.Path(os.environ.get("ESES_BINARY", PROJECT / "build" / "eses-blocks"))

sys.path[:0] = [str(SCRIPTS), str(SCRIPTS / "lib")]  # eses_tools, and the modules of other scripts


def command(script, *arguments):
    return [sys.executable, SCRIPTS / script, *map(str, arguments)]


def run(script, *arguments, **how):
    """Runs a script to its end. Returns returncode, stdout and stderr."""
    return subprocess.run(command(script, *arguments), stdin=subprocess.DEVNULL, timeout=300,
                          capture_output=True, encoding="utf-8", errors="backslashreplace",
                          check=False, **how)


def forget_signals():
    """Gives all signals their default action: a program inherits what this process ignores."""
    for number in signal.valid_signals():
        if signal.getsignal(number) not in (signal.SIG_DFL, None):
            signal.signal(number, signal.SIG_DFL)


def write_program(path, body):
    path.write_text("#!/bin/sh\n" + body)
    path.chmod(0o755)
    return path


def write_map(path, end, half=12):
    """Writes an OpenDX map of a cube with these half sides, whose values grow along x from -end to
    end."""
    side = 2 * half
    path.write_text(f"object 1 class gridpositions counts 2 2 2\norigin {-half} {-half} {-half}\n"
                    f"delta {side} 0 0\ndelta 0 {side} 0\ndelta 0 0 {side}\n"
                    "object 3 class array type double rank 0 items 8 data follows\n"
                    + f"{-end} " * 4 + f"{end} " * 4 + "\n")
    return path


def interpreter_of(script):
    """Returns the interpreter of a script's first line, which has Debian's matplotlib and VTK."""
    return script.read_text(encoding="utf-8").partition("\n")[0].removeprefix("#!")


def can_import(script, module):
    python = interpreter_of(script)
    return os.path.exists(python) and subprocess.run(
        [python, "-c", f"import {module}"], stderr=subprocess.DEVNULL, check=False).returncode == 0


def can_draw():
    """Whether scripts/render works."""
    has_display = os.environ.get("DISPLAY") or shutil.which("Xvfb")
    return bool(has_display) and can_import(SCRIPTS / "render", "vtk")


def python_with(module):
    """Returns an interpreter that has the module, this one or the system's; None without one."""
    for python in (sys.executable, "/usr/bin/python3"):
        try:
            if subprocess.run([python, "-c", f"import {module}"], capture_output=True,
                              check=False).returncode == 0:
                return python
        except OSError:
            pass
    return None


def has_browser():
    return (shutil.which("chromium") and shutil.which("chromedriver")
            and importlib.util.find_spec("selenium") is not None)


def open_browser(test):
    """Returns headless Chromium, driven by Selenium, that ends with the test."""
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium")
    for argument in ("--headless=new", "--no-sandbox", "--use-angle=swiftshader",
                     "--enable-unsafe-swiftshader", "--window-size=900,560",
                     "--force-device-scale-factor=1", f"--user-data-dir={test.folder}/profile"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    browser = webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)
    test.addCleanup(browser.quit)
    browser.set_script_timeout(300)
    browser.set_page_load_timeout(300)
    return browser


def browser_errors(browser):
    return [line for line in browser.get_log("browser") if line["level"] == "SEVERE"]


def accessibility_faults(browser):
    """Returns texts with a contrast below 4.5 (WCAG 2.2), controls without a name, and controls that
    the Tab key does not reach, in the page that the browser shows, with the light and the dark
    theme of the system."""
    faults = []
    for theme in ("light", "dark"):
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {
            "features": [{"name": "prefers-color-scheme", "value": theme}]})
        faults += [f"{theme}: {fault}" for fault in browser.execute_script(r"""
          const numbers = (color) => color.match(/[\d.]+/g).map(Number);
          const light = (color) => numbers(color).slice(0, 3).map((one) => one / 255)
            .map((one) => one <= 0.04045 ? one / 12.92 : ((one + 0.055) / 1.055) ** 2.4)
            .reduce((sum, one, i) => sum + one * [0.2126, 0.7152, 0.0722][i], 0.05);
          const canvas = document.body.appendChild(document.createElement("div"));
          canvas.style.background = "Canvas"; // where no element has a background
          const behind = (one) => {
            if (one === null) return getComputedStyle(canvas).backgroundColor;
            const color = getComputedStyle(one).backgroundColor;
            return (numbers(color)[3] ?? 1) > 0.9 ? color : behind(one.parentElement);
          };
          const faults = [];
          for (const one of document.body.querySelectorAll("*:not(script, noscript, option)")) {
            const isText = Array.from(one.childNodes).some((node) => node.nodeType === 3 && node.data.trim());
            if (!isText || !one.checkVisibility()) continue;
            const [a, b] = [light(getComputedStyle(one).color), light(behind(one))];
            const ratio = Math.max(a / b, b / a);
            if (ratio < 4.5) faults.push(`contrast ${ratio.toFixed(1)}: ${one.textContent}`);
          }
          for (const one of document.querySelectorAll("input, select, button, canvas, img")) {
            const name = one.labels?.length || one.getAttribute("aria-label") || one.alt
              || one.textContent.trim();
            if (!name) faults.push(`no name: ${one.outerHTML}`);
            if (one.matches("input, select, button") && one.tabIndex < 0)
              faults.push(`not reached: ${one.outerHTML}`);
          }
          canvas.remove();
          return faults""")]
    return faults


def skip_without_terminal(test):
    """Skips a test if this system, for example a root directory without /dev/pts, has no
    pseudo-terminals."""
    try:
        for end in pty.openpty():
            os.close(end)
    except OSError as error:
        test.skipTest(f"no terminal can be made: {error}")


def has_matplotlib(script):
    return can_import(script, "matplotlib")


def reads_structures():
    """Returns whether the program reads PDB and mmCIF files, for which it needs gemmi."""
    return not PROGRAM.exists() or "mmCIF" in subprocess.run(
        [PROGRAM, "--version"], capture_output=True, text=True, check=True).stdout


needs_gemmi = unittest.skipUnless(reads_structures(), "this build has no gemmi")


class TestCase(unittest.TestCase):
    """A test case with an empty folder for each test."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def assertDone(self, done, code=0):
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)

    def assertNeedsNo(self, libraries, build):
        """The program of tests/downstream is linked with none of these libraries. Only names of files count:
        those of temporary folders are random, and may contain one of these words."""
        linking = (build / "CMakeFiles/blocks.dir/link.txt").read_text()
        names = [pathlib.Path(word).name for word in linking.split()]
        self.assertIn("blocks", names)
        self.assertEqual([name for name in names for library in libraries if library in name], [])
