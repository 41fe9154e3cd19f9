# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""pip installs the module from a build folder, and it works without that folder; an archive holds the sources.

usage: build_backend_test.py SOURCE BUILD"""
import io
import json
import math
import os
import pathlib
import re
import signal
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import time
import unittest
import zipfile

SOURCE, BUILD = map(pathlib.Path, sys.argv[1:3])
sys.path.insert(0, str(SOURCE / "python"))
import build_backend

VERSION = re.search(r"project\(palpate VERSION (\S+)", (SOURCE / "CMakeLists.txt").read_text())[1]
ENVIRONMENT = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
# Modules that no function of Python loads.
CAMERAS = {f"libpalpate_{name}-{VERSION.rpartition('.')[0]}.so" for name in ("aravis_camera", "video_capture")}
# Debian's python3 and apt need these too.
ALWAYS_INSTALLED = {"libc6", "libgcc-s1", "libstdc++6", "zlib1g"}

USE = """
import importlib.metadata, json, sys, palpate
square = palpate.TriangleMesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 3], [1, 2, 3]])
palpate.write_mesh(sys.argv[1], square)
read = palpate.read_mesh(sys.argv[1])  # .glb: by a module that is loaded then
corner = palpate.SurfaceQuery(read).closest_points([[0, 0, 0]])
loaded = {line.split()[-1] for line in open("/proc/self/maps") if "palpate" in line}
print(json.dumps({"version": importlib.metadata.version("palpate"), "compiled": palpate.__version__,
                  "distance": palpate.geodesic_distance(read, corner).distance.max(), "loaded": sorted(loaded)}))
"""


def output(*words):
    done = subprocess.run(list(map(str, words)), env=ENVIRONMENT, cwd="/", capture_output=True, text=True, check=False)
    if done.returncode:
        raise AssertionError(f"{' '.join(map(str, words))}: exit status {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="palpate-wheel-")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        cls.python = cls.folder / "environment/bin/python"
        output(sys.executable, "-m", "venv", "--without-pip", "--system-site-packages", cls.folder / "environment")
        output(sys.executable, "-m", "pip", "--python", cls.python, "install", "--no-index", "--no-compile",
               "--config-settings", f"build-dir={BUILD}", SOURCE)
        cls.packages = next(cls.folder.glob("environment/lib/python3*/site-packages"))
        cls.information = cls.packages / f"palpate-{VERSION}.dist-info"

    def test_it_works_with_its_own_libraries_and_modules(self):
        found = json.loads(output(self.python, "-B", "-c", USE, self.folder / "square.glb"))
        self.assertEqual((found["version"], found["compiled"]), (VERSION, VERSION))
        self.assertAlmostEqual(found["distance"], math.sqrt(2), places=6)  # across both triangles
        self.assertTrue(any("palpate_assimp" in path for path in found["loaded"]), found["loaded"])
        self.assertEqual([path for path in found["loaded"] if not path.startswith(str(self.packages / "palpate"))], [])

    def test_it_holds_the_package_its_libraries_and_what_is_told_of_them(self):
        listed = {line.split(",")[0] for line in (self.information / "RECORD").read_text().splitlines()}
        present = {str(path.relative_to(self.packages)) for path in self.packages.rglob("*") if path.is_file()}
        self.assertEqual(listed, present)
        api = ".".join(VERSION.split(".")[:2])
        libraries = {f"libpalpate_{name}.so.{api}" for name in ("core", "geometry", "documents", "sensing", "devices", "probing", "haptics")}
        modules = {f"libpalpate_{name}-{api}.so"
                   for name in ("aravis_camera", "assimp", "image_codecs", "ipopt", "mat_array", "registration_pcl", "video_capture")}
        package = {"__init__.py", "_notebook.py", "_palpate.pyi", "py.typed", "page.html",
                   f"_palpate{sysconfig.get_config_var('EXT_SUFFIX')}"}
        self.assertEqual({path.removeprefix("palpate/") for path in present if path.startswith("palpate/")},
                         package | {f"lib/{name}" for name in libraries | modules})
        self.assertEqual((self.information / "METADATA").read_text(),
                         (BUILD / f"python/palpate-{VERSION}.dist-info/METADATA").read_text())
        self.assertEqual((self.information / "NOTICE").read_text(), (BUILD / "NOTICE").read_text())
        self.assertEqual((self.information / "LICENSE").read_text(), (SOURCE / "LICENSE").read_text())

    def test_the_packages_that_it_needs_are_in_the_documentation(self):
        loaded = [path for path in self.packages.glob("palpate/**/*.so*") if path.name not in CAMERAS]
        text = output("objdump", "-p", *loaded)
        needed = {name for name in re.findall(r"NEEDED +(\S+)", text) if "palpate" not in name}
        paths = re.findall(r"^\t(\S+) .*64.* => (\S+)$", output("/sbin/ldconfig", "-p"), re.MULTILINE)
        files = {os.path.realpath(path) for name, path in paths if name in needed}
        # Some packages name a file in /usr/lib as one in /lib, which is the same folder; not all of these are found.
        found = subprocess.run(["dpkg-query", "-S", *files, *(path.removeprefix("/usr") for path in files)],
                               capture_output=True, text=True, check=False).stdout
        packages = set(re.findall("^([^:]+):", found, re.MULTILINE)) - ALWAYS_INSTALLED
        self.assertGreater(len(packages), 10)
        words = set(re.findall(r"[a-z0-9+.-]+", (SOURCE / "docs/python.md").read_text()))
        self.assertEqual(packages - words, set())

    def test_a_library_that_is_missing_is_named_with_what_to_do(self):
        library = next(self.packages.glob("palpate/lib/libpalpate_core.so.*"))
        library.rename(self.folder / library.name)
        try:
            done = subprocess.run([self.python, "-B", "-c", "import palpate"], env=ENVIRONMENT, capture_output=True, text=True, check=False)
        finally:
            (self.folder / library.name).rename(library)
        self.assertRegex(done.stderr.splitlines()[-1], rf"^ImportError: {library.name}: cannot open.*docs/python\.md")


class Wheel(unittest.TestCase):
    def test_the_same_files_make_the_same_bytes(self):
        files = {"b": b"second", "a": b"first"}
        one, other = io.BytesIO(), io.BytesIO()
        build_backend.write_wheel(one, files, "RECORD")
        build_backend.write_wheel(other, dict(sorted(files.items())), "RECORD")
        self.assertEqual(one.getvalue(), other.getvalue())
        with zipfile.ZipFile(one) as wheel:
            self.assertEqual({entry.date_time for entry in wheel.infolist()}, {(1980, 1, 1, 0, 0, 0)})


@unittest.skipUnless((SOURCE / ".git").exists(), "the files of an archive are those of a clone")
class Archive(unittest.TestCase):
    def test_it_holds_what_is_under_version_control(self):
        with tempfile.TemporaryDirectory() as folder:
            name = build_backend.build_sdist(folder)
            self.assertEqual(os.listdir(folder), [name])
            with tarfile.open(pathlib.Path(folder) / name) as archive:
                root = f"palpate-{VERSION}/"
                self.assertEqual(name, f"palpate-{VERSION}.tar.gz")
                files = {entry.name: entry for entry in archive}
                tracked = subprocess.run(["git", "-C", SOURCE, "ls-files", "-z"], capture_output=True, text=True, check=True).stdout
                expected = {root + path for path in tracked.split("\0")[:-1] if os.path.lexists(SOURCE / path)}
                self.assertEqual(set(files), expected | {root + "PKG-INFO"})
                self.assertEqual(archive.extractfile(root + "CMakeLists.txt").read(), (SOURCE / "CMakeLists.txt").read_bytes())
                self.assertIn(f"\nVersion: {VERSION}\n", archive.extractfile(root + "PKG-INFO").read().decode())
                self.assertTrue(files[root + "dev"].mode & 0o111)
                self.assertFalse(files[root + "deps.txt"].mode & 0o111)
                self.assertEqual({(entry.uid, entry.uname, entry.mtime) for entry in files.values()}, {(0, "", 0)})


class Refused(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        for name in ("output", "temporary", "programs"):
            (self.folder / name).mkdir()

    def program(self, name, text):
        (self.folder / "programs" / name).write_text(f"#!/bin/sh\n{text}\n")
        (self.folder / "programs" / name).chmod(0o755)

    def start(self, settings):
        """build_wheel in a process that finds nothing but programs/ and writes nothing but output/ and temporary/."""
        code = f"import build_backend; build_backend.build_wheel({str(self.folder / 'output')!r}, {settings!r})"
        environment = {"PATH": str(self.folder / "programs"), "TMPDIR": str(self.folder / "temporary"),
                       "PYTHONPATH": str(SOURCE / "python")}
        return subprocess.Popen([sys.executable, "-B", "-c", code], env=environment, stdout=subprocess.PIPE,
                                stderr=subprocess.STDOUT, text=True, start_new_session=True)

    def refusal(self, settings=None):
        with self.start(settings) as process:
            text = process.communicate()[0]
        self.assertEqual(process.returncode, 1, text)
        self.assertEqual([list((self.folder / name).iterdir()) for name in ("output", "temporary")], [[], []])
        return text

    def test_a_missing_cmake_is_named(self):
        self.assertRegex(self.refusal(), "^cmake is not installed.*deps.txt")

    def test_what_cmake_does_not_find_is_shown_with_what_to_do(self):
        self.program("cmake", "echo 'Could not find embree' >&2; exit 1")
        self.assertRegex(self.refusal(), "^Could not find embree\nCMake cannot configure.*`./dev setup` installs.*deps.txt")

    def test_an_unknown_setting_is_named(self):
        self.program("cmake", "exit 1")
        self.assertRegex(self.refusal({"builddir": "build"}), "^unknown setting: builddir; it must be build-dir")

    def test_a_folder_without_the_module_is_named(self):
        self.program("cmake", "exit 1")
        self.assertRegex(self.refusal({"build-dir": str(self.folder)}),
                         rf"^{self.folder}: there is no build of palpate-{VERSION} .*\./dev build")

    def test_a_module_that_looks_for_its_libraries_elsewhere_is_refused(self):
        module = self.folder / "build/python/palpate" / f"_palpate{sysconfig.get_config_var('EXT_SUFFIX')}"
        module.parent.mkdir(parents=True)
        module.write_bytes(b"$ORIGIN/../lib")
        (self.folder / f"build/python/palpate-{VERSION}.dist-info").mkdir()
        self.program("cmake", f'prefix=${{1#-DCMAKE_INSTALL_PREFIX=}}; /bin/mkdir -p "$prefix/m"; /bin/cp {module} "$prefix/m/"')
        self.assertRegex(self.refusal({"build-dir": str(self.folder / "build")}), "does not look for its libraries beside itself")

    def test_an_interrupt_leaves_nothing(self):
        self.program("cmake", f"echo begun > {self.folder}/begun; exec /bin/sleep 60")
        with self.start(None) as process:
            while not (self.folder / "begun").exists():
                time.sleep(0.01)
            self.assertNotEqual(list((self.folder / "temporary").iterdir()), [])
            os.killpg(process.pid, signal.SIGINT)
            self.assertIn("KeyboardInterrupt", process.communicate(timeout=20)[0])
        self.assertEqual([list((self.folder / name).iterdir()) for name in ("output", "temporary")], [[], []])

    def test_an_output_that_cannot_be_written_is_named(self):
        with self.assertRaisesRegex(SystemExit, "missing/palpate.whl: cannot be written"):
            with build_backend.replacing(self.folder / "missing/palpate.whl") as path:
                path.write_text("wheel")

    def test_a_result_that_is_not_complete_replaces_nothing(self):
        path = self.folder / "output/palpate.whl"
        path.write_text("old")
        with self.assertRaises(ValueError):
            with build_backend.replacing(path) as part:
                part.write_text("new")
                raise ValueError
        self.assertEqual(path.read_text(), "old")
        self.assertEqual(os.listdir(path.parent), [path.name])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
