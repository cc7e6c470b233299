#!/usr/bin/env python3
"""Installs and runs the packages in fresh trees of Debian, as on a computer that has never seen Feeler.

    bare_trees.py FEELER DEBIAN_PACKAGE ARCHIVE

FEELER: the program that the packages were made from; the reports must be the same. The Debian package is installed in
Debian 12, used and purged again: the tree must then be as before. The archive is unpacked and used in Debian 12 and 13.
Needs root, mmdebstrap and Debian's archive, and takes some minutes. Prints each mistake, exits with 1 if there is one.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
JOB = ("programs/clamped_plate_low.nc", "setups/clamped_plate.toml")
# Written by apt, dpkg and drivers, and not by what a package contains.
OTHERS = re.compile(r"^(proc|sys|dev|tmp|run|root/\.cache|var/(cache|log|lib/(apt|dpkg|systemd))|etc/(ld\.so\.cache|resolv\.conf))(/|$)")
mistakes = []


def expect(is_true, text):
    if not is_true:
        mistakes.append(text)


def run(command, **options):
    done = subprocess.run(command, capture_output=True, text=True, check=False, **options)
    if done.returncode > 1:
        raise SystemExit(f"{' '.join(map(str, command))}:\n{done.stdout}{done.stderr}")
    return done.stdout


def in_tree(tree, *words):
    # The dynamic linker asks /proc where the program is.
    enter = 'mount -t proc proc "$0/proc" && exec chroot "$0" "$@"'
    work = 'mkdir -p /tmp/work && cd /tmp/work && "$@"'
    return run(["unshare", "--mount", "sh", "-c", enter, tree,
                "env", "HOME=/root", "LC_ALL=C.UTF-8", "DEBIAN_FRONTEND=noninteractive", "sh", "-c", work, "sh", *words])


def without_times(report):
    return re.sub(r'"seconds": \{[^}]*\}', '"seconds"', report)


def files_of(tree):
    """The files of a tree, with what tells a change."""
    found = {}
    for folder, names, files in os.walk(tree):
        below = pathlib.Path(folder).relative_to(tree)
        names[:] = [name for name in names if not OTHERS.match(str(below / name))]
        for name in [*names, *files]:
            path = pathlib.Path(folder) / name
            if OTHERS.match(str(below / name)):
                continue
            facts = path.lstat()
            is_file = path.is_file() and not path.is_symlink()
            found[str(below / name)] = (facts.st_mode, facts.st_size if is_file else 0, facts.st_mtime if is_file else 0)
    return found


def expect_same(before, after, when):
    for name in sorted(set(before) | set(after)):
        expect(before.get(name) == after.get(name), f"{when}, {name} is " + (
            "new" if name not in before else "gone" if name not in after else "changed"))


def make_tree(suite, folder):
    run(["mmdebstrap", "--quiet", "--variant=minbase", suite, folder])
    shutil.copy("/etc/resolv.conf", folder / "etc/resolv.conf")
    for apt in pathlib.Path("/etc/apt/apt.conf.d").glob("*proxy*"):
        shutil.copy(apt, folder / "etc/apt/apt.conf.d")
    return folder


def use(tree, feeler, samples, own, where):
    """Checks a sample; the report must be that of the program `own`."""
    program, setup = (f"{samples}/{name}" for name in JOB)
    report = in_tree(tree, feeler, "check", program, "--setup", setup, "--format", "json", "--pairs")
    mine = run([own, "check", JOB[0], "--setup", JOB[1], "--format", "json", "--pairs"], cwd=ROOT / "assets")
    expect(without_times(report).replace(f"{samples}/", "") == without_times(mine), f"{where}: another report")
    expect("feeler" in in_tree(tree, feeler, "--version"), f"{where}: --version")


def try_debian_package(own, package, folder):
    tree = make_tree("bookworm", folder / "package")
    in_tree(tree, "apt-get", "-q", "update")
    shutil.copy(package, tree / "tmp/feeler.deb")
    before = files_of(tree)
    in_tree(tree, "apt-get", "-q", "install", "-y", "/tmp/feeler.deb")
    installed = files_of(tree)
    use(tree, "feeler", "/usr/share/feeler", own, "Debian package")
    in_tree(tree, "feeler", "shot", f"/usr/share/feeler/{JOB[0]}", "--setup", f"/usr/share/feeler/{JOB[1]}", "--worst",
            "-o", "worst.png")
    expect((tree / "tmp/work/worst.png").read_bytes().startswith(b"\x89PNG"), "Debian package: no picture")
    expect_same(installed, files_of(tree), "after use")
    in_tree(tree, "apt-get", "-q", "purge", "-y", "--autoremove", "feeler")
    expect_same(before, files_of(tree), "after purging")


def try_archive(own, archive, suite, folder):
    tree = make_tree(suite, folder / suite)
    # An archive needs the libstdc++ of the compiler, which apt depends on.
    run(["tar", "-C", tree / "opt", "-xf", archive])
    unpacked = next((tree / "opt").glob("feeler-*")).relative_to(tree)
    before = files_of(tree)
    use(tree, f"/{unpacked}/bin/feeler", f"/{unpacked}/share/feeler", own, f"archive in {suite}")
    expect_same(before, files_of(tree), f"after use of the archive in {suite}")


def main():
    own, package, archive = (pathlib.Path(word).resolve() for word in sys.argv[1:4])
    if os.geteuid() != 0:
        raise SystemExit("needs root, for chroot")
    with tempfile.TemporaryDirectory() as folder:
        os.chmod(folder, 0o755)
        folder = pathlib.Path(folder)
        try_debian_package(own, package, folder)
        for suite in ("bookworm", "trixie"):
            try_archive(own, archive, suite, folder)
    for mistake in mistakes:
        print(mistake)
    print(f"{len(mistakes)} mistakes in three trees")
    return 1 if mistakes else 0


if __name__ == "__main__":
    sys.exit(main())
