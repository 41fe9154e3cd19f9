# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""What pip calls (PEP 517): makes a wheel of the module `palpate`, or an archive of the sources.

A wheel is compiled with CMake in a temporary folder. With the setting `build-dir` it is made of what a build folder holds, which
is not built again. It uses the standard library only, because pip runs it where no other packages can be imported.
"""
import base64
import contextlib
import gzip
import hashlib
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
COMPONENTS = ("core", "geometry", "documents", "sensing", "devices", "probing", "haptics", "python")  # python_needs in cmake/palpate_components.cmake
DEPENDENCIES = "`./dev setup` installs the Debian packages that Palpate needs; deps.txt lists them"


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    build_dir(config_settings)
    folder = Path(metadata_directory) / f"{name_and_version()}.dist-info"
    folder.mkdir()
    (folder / "METADATA").write_text(metadata())
    return folder.name


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    del metadata_directory  # the same text is made again
    require("cmake")
    with tempfile.TemporaryDirectory(prefix="palpate-") as folder:
        build = build_dir(config_settings) or compiled(Path(folder) / "build")
        files = packaged(build, Path(folder) / "installed")
        python = f"cp{sys.version_info.major}{sys.version_info.minor}"
        tag = f"{python}-{python}-{re.sub('[-.]', '_', sysconfig.get_platform())}"
        information = f"{name_and_version()}.dist-info"
        files[f"{information}/METADATA"] = metadata().encode()
        files[f"{information}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: palpate\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
        files[f"{information}/LICENSE"] = (ROOT / "LICENSE").read_bytes()
        files[f"{information}/NOTICE"] = (build / "NOTICE").read_bytes()
        name = f"{name_and_version()}-{tag}.whl"
        with replacing(Path(wheel_directory) / name) as path:
            write_wheel(path, files, f"{information}/RECORD")
    return name


def build_sdist(sdist_directory, config_settings=None):
    build_dir(config_settings)
    require("git")
    # Not merely that a repository is found: this folder may lie inside of another one.
    if not (ROOT / ".git").exists():
        raise SystemExit(f"{ROOT}: this is not a clone of the repository, so the files of an archive of the sources are not known")
    listed = run("git", "-C", ROOT, "ls-files", "-z", stdout=subprocess.PIPE).split(b"\0")
    paths = sorted(path for path in map(os.fsdecode, listed) if path and os.path.lexists(ROOT / path))
    name = f"{name_and_version()}.tar.gz"
    with (tempfile.TemporaryDirectory(prefix="palpate-") as folder, replacing(Path(sdist_directory) / name) as archive,
          open(archive, "wb") as file, gzip.GzipFile("", "wb", 6, file, 0) as packed,
          tarfile.open(fileobj=packed, mode="w", format=tarfile.PAX_FORMAT) as tar):
        information = Path(folder) / "PKG-INFO"
        information.write_text(metadata())
        for inside, path in [("PKG-INFO", information), *((path, ROOT / path) for path in paths)]:
            tar.add(path, f"{name_and_version()}/{inside}", recursive=False, filter=without_owner_and_time)
    return name


def build_dir(settings):
    """The folder of the setting build-dir, or None."""
    settings = dict(settings or {})
    folder = settings.pop("build-dir", None)
    if settings:
        raise SystemExit(f"unknown setting: {', '.join(settings)}; it must be build-dir, a folder in which Palpate was built")
    return folder and ROOT / folder


def compiled(folder):
    """Builds the module in a folder."""
    try:
        run("cmake", "--preset", "wheel", "-S", ROOT, "-B", folder, f"-DPALPATE_PYTHON={sys.executable}")
    except subprocess.CalledProcessError:
        raise SystemExit(f"CMake cannot configure the build, for the reason above. {DEPENDENCIES}") from None
    try:
        run("cmake", "--build", folder)
    except subprocess.CalledProcessError:
        raise SystemExit(f"the module cannot be compiled, for the reason above. {DEPENDENCIES}") from None
    return folder


def packaged(build, prefix):
    """The content of each file of the package in a wheel, of what a build installs below a prefix."""
    module = build / "python/palpate" / f"_palpate{sysconfig.get_config_var('EXT_SUFFIX')}"
    if not module.exists() or not (module.parents[1] / f"{name_and_version()}.dist-info").exists():
        version = f"{sys.version_info.major}.{sys.version_info.minor}"
        raise SystemExit(f"{build}: there is no build of {name_and_version()} with the module for Python {version}; ./dev build makes one "
                         "in build/release")
    for component in COMPONENTS:  # not by `cmake --install`, which writes into the build folder
        run("cmake", f"-DCMAKE_INSTALL_PREFIX={prefix}", f"-DCMAKE_INSTALL_COMPONENT={component}", "-DCMAKE_INSTALL_DO_STRIP=ON",
            "-P", build / component / "cmake_install.cmake", stdout=subprocess.DEVNULL)
    package = next(prefix.rglob(module.name)).parent
    # The name by which libraries are loaded, and that of the modules that they load themselves. The other names are for linkers.
    version = r"\.".join(name_and_version().split("-")[1].split(".")[:2])
    libraries = [path for path in prefix.rglob("libpalpate_*") if re.search(rf"(\.so\.|-){version}(\.so)?$", path.name)]
    files = {f"palpate/{path.name}": path.read_bytes() for path in package.iterdir()}
    # Inside of the package, not where a prefix has its libraries: `pip install --target` knows no such folder.
    files.update({f"palpate/lib/{path.name}": path.read_bytes() for path in libraries})
    if b"$ORIGIN/lib" not in files[f"palpate/{module.name}"]:
        raise SystemExit(f"{build}: this build installs a module that does not look for its libraries beside itself, as those of "
                         "Debian packages; ./dev build makes another one in build/release")
    return files


def write_wheel(path, files, record):
    """Writes a wheel with the list of its files. The same files make the same bytes."""
    lines = []
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as wheel:
        def add(name, content):
            entry = zipfile.ZipInfo(name)  # of 1980
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o100644 << 16
            wheel.writestr(entry, content)

        for name, content in sorted(files.items()):
            add(name, content)
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).decode().rstrip("=")
            lines.append(f"{name},sha256={digest},{len(content)}\n")
        add(record, "".join([*lines, f"{record},,\n"]))


def metadata():
    """What CMake makes of METADATA.in, which is asked for where nothing is configured."""
    project = re.search(r'^project\(palpate VERSION (?P<VERSION>\S+).*?DESCRIPTION "(?P<DESCRIPTION>[^"]*)"',
                        (ROOT / "CMakeLists.txt").read_text(), re.MULTILINE | re.DOTALL)
    return re.sub("@PROJECT_([A-Z]+)@", lambda name: project[name[1]], (ROOT / "python/METADATA.in").read_text())


def name_and_version():
    return "palpate-" + re.search("^Version: (.*)$", metadata(), re.MULTILINE)[1]


def without_owner_and_time(entry):
    entry.uid = entry.gid = entry.mtime = 0
    entry.uname = entry.gname = ""
    entry.mode = 0o755 if entry.mode & 0o100 else 0o644
    return entry


@contextlib.contextmanager
def replacing(path):
    """The path to write to; it gets its name when it is complete."""
    part = path.with_name(f"{path.name}.tmp-{os.getpid()}")
    try:
        yield part
        part.replace(path)
    except OSError as error:
        raise SystemExit(f"{path}: cannot be written: {error}") from None
    finally:
        if part.exists():
            part.unlink()


def require(program):
    if shutil.which(program) is None:
        raise SystemExit(f"{program} is not installed. {DEPENDENCIES}")


def run(*words, stdout=None):
    return subprocess.run(list(map(str, words)), check=True, stdout=stdout).stdout
