#!/usr/bin/env python3
"""Checks the contents of packages: links in the documents, licences, and what the system reads in them.

    packages.py PACKAGE...      .deb, .tar.gz or .zip; prints each mistake, exits with 1 if there is one
"""
import pathlib
import re
import subprocess
import sys
import tempfile

import documentation

ROOT = pathlib.Path(__file__).resolve().parent.parent
VERSION = re.search(r"^project\(feeler VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"),
                    flags=re.M)[1]
IN_EACH = {"musl.txt", "libglm-dev.txt", "libexpected-dev.txt", "libasio-dev.txt", "libcli11-dev.txt", "nlohmann-json3-dev.txt"}
IN_ARCHIVES = {"fonts-inter.txt", "fonts-jetbrains-mono.txt", "fonts-font-awesome.txt"}
IN_WINDOWS = {"imgui.txt", "freetype.txt", "sqlite.txt", "gcc.txt", "mingw-w64.txt"}
# What a driver of the system needs in its own version.
LEFT_TO_THE_SYSTEM = re.compile(r"lib(c|m|stdc\+\+|gcc_s|z|tinfo|GL|EGL|OpenGL|drm|gbm)\.so")


def unpack(package, folder):
    if package.suffix == ".deb":
        subprocess.run(["dpkg-deb", "-R", package, folder], check=True)
    else:
        subprocess.run(["cmake", "-E", "tar", "xf", package], cwd=folder, check=True)


def licences_of_libraries(libraries):
    """The names of the files with the licences of libraries, after their Debian packages."""
    for library in libraries:
        found = subprocess.run(["dpkg-query", "-S", f"*/{library.name}"], capture_output=True, text=True, check=True)
        yield found.stdout.partition(":")[0] + ".txt"


def wrong_licences(tree, needed):
    there = {file.name: file for folder in tree.rglob("licences") for file in folder.rglob("*") if file.is_file()}
    for name in sorted(needed - set(there)):
        yield f"there is no licences/{name}"
    if list(tree.glob("DEBIAN")):
        return  # Debian has the common licences
    for name, file in there.items():
        for common in re.findall(r"/usr/share/common-licenses/([\w.-]*\w)", file.read_text(encoding="utf-8")):
            if common not in there:
                yield f"licences/{name} refers to {common}, which is missing"


def wrong_desktop_files(tree):
    for file in tree.rglob("*.metainfo.xml"):
        if f'<release version="{VERSION}"' not in file.read_text(encoding="utf-8"):
            yield f"{file.name} has no release {VERSION}"
    for file in tree.rglob("*.cmd"):
        if re.search(rb"(?<!\r)\n", file.read_bytes()):
            yield f"{file.name} has lines that do not end with CR LF, which cmd.exe needs"


def wrong_in_debian_package(tree):
    text = next(tree.glob("usr/share/doc/*/copyright")).read_text(encoding="utf-8")
    for author in ("MaestroFusion360", "musl"):
        if author not in text:
            yield f"debian/copyright does not name {author}"
    control = (tree / "DEBIAN" / "control").read_text(encoding="utf-8")
    for package in ("libgl1", "libegl1", "libgl1-mesa-dri"):
        if not re.search(rf"^Recommends:.*\b{package}(,|$)", control, flags=re.M):
            yield f"{package} is not recommended"
    reader = tree / "usr" / "lib" / "feeler" / "feeler-cad"
    if reader.is_file() and not re.search(r"^Recommends:.*\blibocct-", control, flags=re.M):
        yield "the libraries of feeler-cad are not recommended"


def mistakes(package):
    with tempfile.TemporaryDirectory() as folder:
        tree = pathlib.Path(folder).resolve() / "tree"
        tree.mkdir()
        unpack(package, tree)
        found = documentation.wrong_links(tree) + list(wrong_desktop_files(tree))
        libraries = [file for file in tree.rglob("*.so*") if file.is_file()]
        found += [f"{file.name} belongs to the system" for file in libraries if LEFT_TO_THE_SYSTEM.match(file.name)]
        needed = IN_EACH | set(licences_of_libraries(libraries))
        if package.suffix == ".deb":
            found += wrong_in_debian_package(tree)
        else:
            needed |= IN_ARCHIVES
        # The 3D view of reports, which a build without a network lacks.
        programs = [*tree.rglob("bin/feeler"), *tree.rglob("feeler.exe")]
        if any(b"Three.js Authors" in program.read_bytes() for program in programs):
            needed.add("three.js.txt")
        needed |= IN_WINDOWS if package.suffix == ".zip" else {"libimgui-dev.txt"}
        return found + list(wrong_licences(tree, needed))


def main(packages):
    found = [f"{package.name}: {mistake}" for package in packages for mistake in mistakes(package)]
    for mistake in found:
        print(mistake)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main([pathlib.Path(argument).resolve() for argument in sys.argv[1:]]))
