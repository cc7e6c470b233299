#!/usr/bin/env python3
"""Tests feeler.exe under wine: the same verdicts and bits as on Linux, and what differs on Windows.

    windows_test.py ARCHIVE_FOLDER FEELER SOURCE_FOLDER [TEST ...]

ARCHIVE_FOLDER: where the archive for Windows was unpacked. FEELER: the program for Linux, built from the same
sources. Needs wine and Xvfb, since wine has OpenGL on a display only. Skipped unless FEELER_WINDOWS is set, because
the archive takes some minutes to build.
"""

import json
import os
import pathlib
import pty
import re
import select
import shutil
import subprocess
import sys
import tempfile
import time  # clock: for patience
import unittest

if not os.environ.get("FEELER_WINDOWS"):
    print("skipped: without FEELER_WINDOWS, feeler.exe is not built")
    sys.exit(77)

ARCHIVE, LINUX, SOURCE = (pathlib.Path(argument).resolve() for argument in sys.argv[1:4])
EXE = next(ARCHIVE.glob("feeler-*/feeler.exe"))
PATIENCE = 300  # clock: s, for what hangs

# Letters of several scripts, as in the names of programs; the last needs two units of UTF-16.
ANY_SCRIPT = "Täsche Пр 加工 🔧"

# Programs and their set-ups, relative to the source folder.
JOBS = [
    ("assets/programs/TEST_G90.NC", "assets/setups/test_g90.toml"),
    ("assets/programs/TEST_G90.NC", None),
]


def planted(count):
    """Some of the planted programs with their set-ups: every n-th row of their table."""
    lines = (SOURCE / "tests/planted/table.txt").read_text(encoding="utf-8").splitlines()
    rows = [line.split() for line in lines if line and not line.startswith("#")]
    folder = "tests/planted/"
    jobs = [(folder + row[2], f"{folder}setups/{row[4]}.toml" if row[4] != "-" else None) for row in rows]
    return jobs[::max(1, len(jobs) // count)]


class Wine:
    """A screen and a wine prefix of its own."""

    def __init__(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="feeler-wine-"))
        read, write = os.pipe()
        self.screen = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "1440x900x24"],
                                       pass_fds=[write], stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as pipe:
            display = pipe.readline().strip()
        self.env = {**os.environ, "DISPLAY": f":{display}", "WINEPREFIX": str(self.folder / "prefix"),
                    "WINEDEBUG": "-all", "WINEDLLOVERRIDES": "mscoree,mshtml=", "LC_ALL": "C.UTF-8"}
        # The server stays, so that not every call starts it.
        (self.folder / "prefix").mkdir()
        subprocess.run(["wineserver", "-p"], env=self.env, check=True)
        subprocess.run(["wine", "wineboot", "--init"], env=self.env, check=True, stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL, timeout=PATIENCE)  # clock: for what hangs

    def close(self):
        subprocess.run(["wineserver", "-k"], env=self.env, check=False)
        self.screen.terminate()
        self.screen.wait()
        shutil.rmtree(self.folder, ignore_errors=True)


def setUpModule():
    global wine
    wine = Wine()


def tearDownModule():
    wine.close()


def without_times(report):
    """A report without the times that it took and the drive of the source folder: all that may differ."""
    report = re.sub(r'"seconds": ?(\{[^}]*\}|[-+.e0-9]+)', '"seconds"', report)
    report = re.sub(r'\btime="[.0-9]+"', "time", report)  # of JUnit
    report = re.sub(r"(MB; )[.0-9]+ s$", r"\1", report, flags=re.MULTILINE)  # of the model
    report = re.sub(r"^  seconds +model .*$", "", report, flags=re.MULTILINE)  # of a distance
    return report.replace("file:///Z:/", "file:///")


def windows_path(path):
    return "Z:" + str(path).replace("/", "\\")


class Case(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="feeler-windows-")).resolve()
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def run_program(self, command, arguments, env=None, cwd=SOURCE, status=None):
        done = subprocess.run([*command, *map(str, arguments)], cwd=cwd, env=env, capture_output=True,
                              timeout=PATIENCE, check=False)  # clock: for what hangs
        done.out, done.err = done.stdout.decode("utf-8"), done.stderr.decode("utf-8")
        if status is not None:
            self.assertEqual(done.returncode, status, done.out + done.err)
        return done

    def windows(self, *arguments, **options):
        return self.run_program(["wine", EXE], arguments, env=wine.env, **options)

    def linux(self, *arguments, **options):
        return self.run_program([LINUX], arguments, **options)

    def copy(self, name, program="assets/programs/TEST_G90.NC", setup="assets/setups/test_g90.toml"):
        """A copy of a program under another name, with its set-up next to it."""
        target = self.folder / f"{name}.NC"
        shutil.copy(SOURCE / program, target)
        text = (SOURCE / setup).read_text(encoding="utf-8").replace("../", f"{SOURCE}/assets/")
        target.with_suffix(".toml").write_text(text, encoding="utf-8")
        return target


class SameBits(Case):
    def test_json_reports_are_equal(self):
        for program, setup in JOBS + planted(60):
            with self.subTest(program=program, setup=setup):
                arguments = ["check", program, "--format", "json", "--blocks"]
                if setup:
                    arguments += ["--setup", setup]
                here, there = self.linux(*arguments), self.windows(*arguments)
                self.assertEqual(there.returncode, here.returncode, there.err)
                self.assertEqual(without_times(there.out), without_times(here.out))
                self.assertEqual(there.err, here.err)

    def test_reports_of_all_shared_programs_are_equal(self):
        programs = "../shared/programs"
        if not (SOURCE / programs).is_dir():
            self.assertNotIn("FEELER_REQUIRE_SHARED", os.environ, "the shared programs are missing")
            self.skipTest("the shared programs are missing")
        arguments = ["check", programs, "--no-cache", "--format", "jsonl", "--jobs", "1"]
        here, there = self.linux(*arguments), self.windows(*arguments)
        self.assertEqual(there.returncode, here.returncode, there.err)
        self.assertGreater(len(here.out.splitlines()), 100)
        for mine, other in zip(here.out.splitlines(), there.out.splitlines(), strict=True):
            self.assertEqual(without_times(other), without_times(mine))

    def test_functions_of_programs_are_equal(self):
        """Coordinates from every function, also at the numbers next to a half, where roundings differ."""
        numbers = ["0.7-0.2", "0.2-0.7", "2.5", "-2.5", "0.1*3.", "1/3.", "0.000000001", "77.7", "4503599.5"]
        bracket = {"fanuc": "[{}]", "haas": "[{}]", "linuxcnc": "[{}]", "siemens": "({})"}
        functions = {
            "fanuc": "ROUND FIX FUP SIN COS TAN ATAN SQRT ABS EXP",
            "haas": "ROUND FIX FUP SIN COS TAN ATAN SQRT ABS EXP",
            "linuxcnc": "ROUND FIX FUP SIN COS TAN SQRT ABS EXP",
            "siemens": "ROUND TRUNC SIN COS TAN SQRT ABS EXP",
        }
        for dialect, names in functions.items():
            lines = ["G21 G90" if dialect != "siemens" else "G71 G90", "G0 X0 Y0 Z0"]
            for name in names.split():
                for number in numbers[:-2] if name == "EXP" else numbers:
                    inner = bracket[dialect].format(number)
                    if name == "SQRT":
                        inner = bracket[dialect].format("ABS" + inner)
                    value = name + inner
                    if name == "ATAN":
                        value += "/[3.]"
                    value = bracket[dialect].format(f"{value}/7") if dialect != "siemens" else f"={value}/7"
                    lines.append(f"G1 X{value} F100")
            program = self.folder / f"functions.{'mpf' if dialect == 'siemens' else 'nc'}"
            program.write_text("\n".join([*lines, "M30", ""]), encoding="utf-8")
            with self.subTest(dialect=dialect):
                arguments = ["trace", program.name, "--dialect", dialect, "--format", "jsonl"]
                here, there = self.linux(*arguments, cwd=self.folder), self.windows(*arguments, cwd=self.folder)
                self.assertEqual(here.returncode, 0, here.err)
                self.assertEqual(there.out, here.out)

    def test_other_commands_are_equal(self):
        program, setup = "assets/programs/clamped_plate_low.nc", "assets/setups/clamped_plate.toml"
        for arguments in (["coproc", program, "--setup", setup, "--format", "json"],
                          ["setup", program],
                          ["trace", program],
                          ["diff", program, "assets/programs/clamped_plate.nc", "--setup", setup, "--format", "json"]):
            with self.subTest(command=arguments[0]):
                here, there = self.linux(*arguments), self.windows(*arguments)
                self.assertLess(here.returncode, 2, here.err)
                self.assertEqual(there.returncode, here.returncode, there.err)
                self.assertEqual(without_times(there.out), without_times(here.out))

    def test_benchmarks_have_times(self):
        rows = self.windows("bench", "paper", "--format", "csv", status=0).out.splitlines()
        times = [float(cell) for row in rows[1:] for name, cell in zip(rows[0].split(","), row.split(","))
                 if "seconds" in name or name.endswith("_us") or name.endswith("_ms")]
        self.assertTrue(times, rows[0])
        self.assertGreater(min(times), 0.0)

    def test_other_reports_are_equal(self):
        for form in ("text", "csv", "jsonl", "sarif", "junit"):
            with self.subTest(form=form):
                arguments = ["check", JOBS[0][0], "--setup", JOBS[0][1], "--format", form]
                self.assertEqual(without_times(self.windows(*arguments).out),
                                 without_times(self.linux(*arguments).out))

    def test_tolerances_are_equal(self):
        arguments = ["check", JOBS[0][0], "--setup", JOBS[0][1], "--tolerances", "--format", "json"]
        self.assertEqual(without_times(self.windows(*arguments).out), without_times(self.linux(*arguments).out))

    def test_distances_are_equal(self):
        arguments = ["distance", "sphere:3", "box:1,2,3"]
        here = self.linux(*arguments)
        self.assertEqual(here.returncode, 0, here.err)
        self.assertEqual(without_times(self.windows(*arguments).out), without_times(here.out))


class CommandLine(Case):
    def test_help_and_version(self):
        self.assertIn("feeler ", self.windows("--version", status=0).out)
        self.assertEqual(self.windows("check", "--help", status=0).out.replace("feeler.exe", "feeler"),
                         self.linux("check", "--help", status=0).out)

    def test_misuse_has_status_2(self):
        self.assertEqual(self.windows("check", "--no-such-option", status=2).out, "")

    def test_names_in_any_script(self):
        program = self.copy(ANY_SCRIPT)
        report = self.windows("check", windows_path(program), "--format", "json")
        self.assertIn(report.returncode, (0, 1), report.err)
        self.assertEqual(json.loads(report.out)["program"]["file"].rsplit("/", 1)[-1], program.name)
        output = self.folder / f"{ANY_SCRIPT}.json"
        self.windows("check", windows_path(program), "--format", "json", "-o", windows_path(output))
        self.assertEqual(without_times(output.read_text(encoding="utf-8")), without_times(report.out))

    def test_backslashes_and_drive_letters(self):
        plain = self.windows("check", "assets/programs/TEST_G90.NC", "--setup", "assets/setups/test_g90.toml",
                             "--format", "json")
        back = self.windows("check", r"assets\programs\TEST_G90.NC", "--setup", r"assets\setups\test_g90.toml",
                            "--format", "json")
        self.assertEqual(without_times(back.out), without_times(plain.out))
        drive = self.windows("check", windows_path(SOURCE / "assets/programs/TEST_G90.NC"), "--setup",
                             windows_path(SOURCE / "assets/setups/test_g90.toml"), "--format", "json")
        self.assertEqual(drive.returncode, plain.returncode, drive.err)
        self.assertEqual(json.loads(drive.out)["verdict"], json.loads(plain.out)["verdict"])

    def test_names_of_devices_are_not_opened(self):
        for name in ("aux.nc", "CON", "com1.nc"):
            report = self.windows("check", name, cwd=self.folder, status=2)
            self.assertIn("device", report.err)

    def test_long_paths(self):
        deep = self.folder
        while len(str(deep)) < 400:
            deep = deep / "a_folder_with_a_long_name_0123456789"
        deep.mkdir(parents=True)
        program = self.copy("long")
        for file in (program, program.with_suffix(".toml")):
            shutil.copy(file, deep)
        report = self.windows("check", windows_path(deep / program.name), "--format", "text")
        self.assertEqual(report.returncode, 1, report.out + report.err)

    def test_folders_with_long_paths_are_listed(self):
        deep = self.folder / "jobs"
        while len(str(deep)) < 300:
            deep = deep / "a_folder_with_a_long_name_0123456789"
        deep.mkdir(parents=True)
        program = self.copy("long")
        for file in (program, program.with_suffix(".toml")):
            shutil.copy(file, deep)
        batch = self.windows("check", windows_path(self.folder / "jobs"), "--no-cache", status=1)
        self.assertIn("long.NC", batch.out)
        self.assertIn("1 program", batch.out)

    def test_rooted_paths_without_a_drive(self):
        self.copy("rooted")
        for folder in (windows_path(self.folder)[2:], str(self.folder)):
            batch = self.windows("check", folder, cwd=self.folder.parent, status=1)
            self.assertEqual(batch.err, "")
            self.assertTrue((self.folder / ".feeler/results.db").is_file())
            shutil.rmtree(self.folder / ".feeler")

    def test_patterns_count_characters(self):
        self.copy("\u00fc")
        for program in (self.linux, self.windows):
            batch = program("check", "?.NC", "--no-cache", cwd=self.folder, status=1)
            self.assertIn("\u00fc.NC", batch.out)

    def test_long_path_prefix(self):
        program = self.copy("prefix")
        plain = self.windows("check", windows_path(program), "--format", "json")
        prefixed = self.windows("check", "\\\\?\\" + windows_path(program), "--format", "json")
        self.assertEqual(without_times(prefixed.out), without_times(plain.out))

    def test_devices_are_written_to(self):
        self.windows("check", JOBS[0][0], "--setup", JOBS[0][1], "--format", "json", "-o", "NUL", status=1)
        self.assertEqual([path for path in SOURCE.iterdir() if path.name.lower().startswith("nul")], [])

    def test_ini_files_have_colons(self):
        (self.folder / "subs").mkdir()
        (self.folder / "subs/hole.ngc").write_text("o<hole> sub\nG1 X5 F100\no<hole> endsub\nM2\n", encoding="utf-8")
        (self.folder / "main.ngc").write_text("G21 G90\no<hole> call\nM2\n", encoding="utf-8")
        (self.folder / "mill.ini").write_text("[RS274NGC]\nSUBROUTINE_PATH = macros:subs\n", encoding="utf-8")
        arguments = ["check", "main.ngc", "--dialect", "linuxcnc", "--ini", "mill.ini", "--format", "json"]
        here = self.linux(*arguments, cwd=self.folder, status=0)
        there = self.windows(*arguments, cwd=self.folder, status=0)
        self.assertEqual(without_times(there.out), without_times(here.out))

    def test_line_ends_of_windows(self):
        program = self.copy("crlf")
        before = self.windows("check", windows_path(program), "--format", "json").out
        program.write_bytes(program.read_bytes().replace(b"\r\n", b"\n").replace(b"\n", b"\r\n"))
        after = json.loads(self.windows("check", windows_path(program), "--format", "json").out)
        self.assertEqual(after["verdict"], json.loads(before)["verdict"])
        self.assertEqual(after.get("findings"), json.loads(before).get("findings"))

    def test_missing_files_are_named(self):
        missing = self.windows("check", r"no\such.nc", status=2)
        self.assertIn("no/such.nc", missing.err)

    def test_locked_reports_stay_whole(self):
        output = self.folder / "locked.json"
        holder = subprocess.Popen(["wine", "cmd", "/c", f"pause > {windows_path(output)}"], env=wine.env,
                                  stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(holder.wait)
        self.addCleanup(holder.kill)
        end = time.monotonic() + PATIENCE  # clock: gives up on what hangs
        while not output.exists() or output.stat().st_size == 0:
            self.assertLess(time.monotonic(), end)  # clock: as above
            time.sleep(0.1)  # clock: polls
        before = output.read_bytes()
        arguments = ["check", JOBS[0][0], "--setup", JOBS[0][1], "--format", "json", "-o", windows_path(output)]
        refused = self.windows(*arguments, status=2)
        self.assertIn("locked.json: cannot be replaced", refused.err)
        self.assertEqual(output.read_bytes(), before)
        self.assertEqual(list(self.folder.iterdir()), [output])
        holder.communicate(b"\r\n")
        self.windows(*arguments, status=1)
        self.assertIn("feeler", json.loads(output.read_text(encoding="utf-8")))

    def test_debugger_reads_standard_input(self):
        done = subprocess.run(["wine", EXE, "debug", "assets/programs/TEST_G90.NC", "--setup",
                               "assets/setups/test_g90.toml"], cwd=SOURCE, env=wine.env,
                              input=b"info program\r\nquit\r\n", capture_output=True,
                              timeout=PATIENCE, check=False)  # clock: for what hangs
        self.assertEqual(done.returncode, 0, done.stderr)


class Console(Case):
    """With a terminal, as from a shell."""

    def talk(self, arguments, answer=b"", after=b""):
        """Status and output of feeler.exe in a terminal. `answer` is typed once it has printed `after`."""
        process, terminal = pty.fork()
        if process == 0:
            os.chdir(SOURCE)
            os.execvpe("wine", ["wine", str(EXE), *map(str, arguments)], wine.env)
        self.addCleanup(os.close, terminal)
        printed, end = b"", time.monotonic() + PATIENCE  # clock: gives up on what hangs
        while True:
            self.assertLess(time.monotonic(), end, printed)  # clock: as above
            try:
                piece = os.read(terminal, 65536) if select.select([terminal], [], [], 1.0)[0] else None
            except OSError:  # the other side is closed
                break
            if piece == b"":
                break
            printed += piece or b""
            if answer and after in printed:
                os.write(terminal, answer)
                answer = b""
        return os.waitstatus_to_exitcode(os.waitpid(process, 0)[1]), printed

    def test_colours(self):
        status, printed = self.talk(["check", *JOBS[0][:1], "--setup", JOBS[0][1]])
        self.assertEqual(status, 1, printed)
        self.assertIn(b"\x1b[31merror\x1b[0m", printed)
        self.assertNotIn("\x1b", self.windows("check", JOBS[0][0], "--setup", JOBS[0][1]).out)

    def test_control_c_ends_watching(self):
        program = self.copy("watched")
        status, printed = self.talk(["check", windows_path(program), "--watch"], b"\x03", b"Ctrl-C ends it")
        self.assertEqual(status, 1, printed)  # of the last check

    def test_control_c_ends_a_batch_and_keeps_its_results(self):
        self.copy("a")
        (self.folder / "endless.nc").write_text("G21 G90\n" + "G1 X0 Y0 Z0 F100\nX1 Y1\nX0 Y0\n" * 300_000,
                                                encoding="utf-8")
        status, printed = self.talk(["check", windows_path(self.folder), "--jobs", "2"], b"\x03", b"a.NC")
        self.assertNotIn(status, (0, 1), printed)
        self.assertTrue((self.folder / ".feeler").exists())


class Shares(Case):
    """Network shares: wine has those that are folders in `dosdevices/unc`."""

    def setUp(self):
        super().setUp()
        self.share = pathlib.Path(wine.env["WINEPREFIX"]) / "dosdevices/unc/server/share"
        self.addCleanup(shutil.rmtree, self.share, ignore_errors=True)
        (self.share / "job").mkdir(parents=True)
        shutil.copytree(SOURCE / "assets", self.share / "assets")
        for name in ("a", ANY_SCRIPT):
            program = self.copy(name)
            shutil.copy(program, self.share / "job")
            text = program.with_suffix(".toml").read_text(encoding="utf-8").replace(f"{SOURCE}/assets", "../assets")
            (self.share / "job" / f"{name}.toml").write_text(text, encoding="utf-8")

    def test_reports_are_as_from_a_drive(self):
        here = self.windows("check", r"\\server\share\job\a.NC", "--format", "json", status=1)
        report = json.loads(here.out)
        self.assertEqual(report["program"]["file"], "//server/share/job/a.NC")
        there = self.linux("check", self.share / "job/a.NC", "--format", "json", status=1)
        self.assertEqual(report["findings"], json.loads(there.out)["findings"])
        slashes = self.windows("check", "//server/share/job/a.NC", "--format", "json", status=1)
        self.assertEqual(without_times(slashes.out), without_times(here.out))

    def test_files_are_written_there(self):
        self.windows("check", r"\\server\share\job\a.NC", "--format", "sarif", "-o", r"\\server\share\out.sarif",
                     status=1)
        self.assertIn("file://server/share/job/a.NC", (self.share / "out.sarif").read_text(encoding="utf-8"))
        self.windows("setup", rf"\\server\share\job\{ANY_SCRIPT}.NC", "-o", r"\\server\share\new.toml", status=0)
        self.assertTrue((self.share / "new.toml").exists())

    def test_inputs_are_not_overwritten_by_another_name(self):
        drive = windows_path(self.share / "job" / "a.NC")
        before = (self.share / "job/a.NC").read_bytes()
        for program, output in ((drive, r"\\server\share\job\a.NC"), (r"\\server\share\job\a.NC", drive)):
            refused = self.windows("check", program, "--format", "json", "-o", output, status=2)
            self.assertIn("is an input and would be overwritten", refused.err)
            self.assertEqual((self.share / "job/a.NC").read_bytes(), before)

    def test_batches_keep_their_results_there(self):
        self.windows("check", r"\\server\share\job", status=1)
        self.assertTrue((self.share / "job/.feeler/results.db").exists())
        for folder in (r"\\server\share\job", "//server/share/job"):
            again = self.windows("check", folder, status=1)
            self.assertIn("2 of 2 results come from earlier checks", again.out + again.err)
        history = self.windows("history", r"\\server\share\job\a.NC", status=0)
        self.assertIn("//server/share/job/a.NC: 1 version", history.out)

    def test_search_path_has_several_folders(self):
        (self.share / "subs").mkdir()
        (self.share / "subs/O2000.nc").write_text("O2000\nG1 X5. F100.\nM99\n", encoding="utf-8")
        (self.folder / "main.nc").write_text("%\nO1\nG21 G90 G54\nM98 P2000\nM30\n%\n", encoding="utf-8")
        arguments = ["check", windows_path(self.folder / "main.nc"), "--dialect", "fanuc", "--format", "json"]
        self.windows(*arguments, status=2)
        found = self.windows(*arguments, "--search-path", rf"{windows_path(self.folder)};\\server\share\subs")
        self.assertIn(found.returncode, (0, 1), found.err)


class FileManager(Case):
    def windows_on_screen(self):
        for _ in range(5):  # it fails when a window closes while it lists them
            listed = subprocess.run(["xwininfo", "-root", "-tree"], env=wine.env, capture_output=True, text=True,
                                    check=False)
            if listed.returncode == 0:
                return listed.stdout
        listed.check_returncode()
        return listed.stdout

    def test_opens_the_window_and_closes_the_console(self):
        for file in ([], [windows_path(SOURCE / JOBS[0][0])]):
            with self.subTest(file=file):
                opened = subprocess.Popen(["wine", "start", "/wait", "/unix", str(EXE), *file], env=wine.env)
                title = '"TEST_G90.NC' if file else '"feeler"'
                end = time.monotonic() + PATIENCE  # clock: gives up on what hangs
                while title not in self.windows_on_screen() or "wineconsole" in self.windows_on_screen():
                    self.assertIsNone(opened.poll(), "the window has closed")
                    self.assertLess(time.monotonic(), end, self.windows_on_screen())  # clock: as above
                    time.sleep(0.2)  # clock: polls
                subprocess.run(["wine", "taskkill", "/f", "/im", "feeler.exe"], env=wine.env, check=True,
                               stdout=subprocess.DEVNULL)
                opened.wait(PATIENCE)  # clock: as above

    def test_open_with_is_registered_and_removed(self):
        script = self.folder / "R&D (new)! 2!" / "open-with.cmd"
        script.parent.mkdir()
        shutil.copy(EXE.parent / "open-with.cmd", script)
        (script.parent / "feeler.exe").touch()

        def query(key):
            return subprocess.run(["wine", "reg", "query", rf"HKCU\Software\Classes\{key}", "/s"], env=wine.env,
                                  capture_output=True, text=True, check=False)

        subprocess.run(["wine", "cmd", "/c", script.name], cwd=script.parent, env=wine.env, check=True,
                       stdout=subprocess.DEVNULL)
        self.assertIn(f'"{windows_path(script.parent)}\\feeler.exe" view "%1"', query("Feeler.Program").stdout)
        for ending in ("nc", "ngc", "mpf", "h"):
            self.assertIn("Feeler.Program", query(rf".{ending}\OpenWithProgids").stdout)
        subprocess.run(["wine", "cmd", "/c", script.name, "remove"], cwd=script.parent, env=wine.env, check=True,
                       stdout=subprocess.DEVNULL)
        self.assertNotEqual(query("Feeler.Program").returncode, 0)
        self.assertNotIn("Feeler.Program", query(r".nc\OpenWithProgids").stdout)

    def test_open_with_refuses_a_percent_sign(self):
        script = self.folder / "100 %" / "open-with.cmd"
        script.parent.mkdir()
        shutil.copy(EXE.parent / "open-with.cmd", script)
        (script.parent / "feeler.exe").touch()
        done = subprocess.run(["wine", "cmd", "/c", script.name], cwd=script.parent, env=wine.env, check=False,
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertIn("may have % in its name", done.stdout)


class Batch(Case):
    def test_checks_a_folder_and_keeps_results(self):
        for name in ("a", "b", ANY_SCRIPT):
            self.copy(name)
        first = self.windows("check", windows_path(self.folder), "--format", "json", status=1)
        self.assertTrue((self.folder / ".feeler").exists())
        names = {pathlib.PurePosixPath(p["program"]).name for p in json.loads(first.out)["programs"]}
        self.assertEqual(names, {"a.NC", "b.NC", f"{ANY_SCRIPT}.NC"})
        second = self.windows("check", windows_path(self.folder), status=1)
        self.assertIn("3 of 3 results come from earlier checks", second.out + second.err)
        (self.folder / "a.NC").write_text("G21 G90\nG0 X0 Y0\nM30\n", encoding="utf-8")
        third = self.windows("check", windows_path(self.folder))
        self.assertIn("2 of 3 results come from earlier checks", third.out + third.err)

    def test_names_that_differ_in_case_are_one_program(self):
        self.copy("a")
        both = self.windows("check", "a.NC", "A.nc", "--no-cache", "--format", "json", cwd=self.folder)
        self.assertEqual(len(json.loads(both.out)["programs"]), 1)
        self.windows("check", ".", cwd=self.folder)
        history = self.windows("history", windows_path(self.folder).upper() + "\\A.nc", "--format", "json", status=0)
        self.assertEqual(len(json.loads(history.out)["versions"]), 1)

    def test_paths_are_reported_with_slashes(self):
        self.copy("a")
        (self.folder / "sub").mkdir()
        for name in ("bad", "other"):
            (self.folder / "sub" / f"{name}.nc").write_text("G21 G90\nG1 Xabc\n", encoding="utf-8")
        for arguments in (["check", "sub\\bad.nc"], ["trace", "sub\\bad.nc"], ["diff", "sub\\bad.nc", "sub\\other.nc"]):
            told = self.windows(*arguments, cwd=self.folder)
            self.assertIn("sub/bad.nc", told.out + told.err)
            self.assertNotIn("sub\\bad", told.out + told.err)

    def test_shards_are_merged_by_a_pattern(self):
        for name in ("a", "b"):
            self.copy(name)
        for i in (1, 2):
            self.windows("check", ".", "--no-cache", "--shard", f"{i}/2", "--format", "shard", "-o", f"part-{i}.json",
                         cwd=self.folder)
        merged = self.windows("merge", "part-*.json", "--format", "json", cwd=self.folder, status=1)
        self.assertEqual(len(json.loads(merged.out)["programs"]), 2)

    def test_patterns_ignore_case_as_the_file_system_does(self):
        self.copy("a")
        self.copy("b")
        found = self.windows("check", windows_path(self.folder / "*.nc"), "--no-cache", "--format", "json")
        self.assertEqual(len(json.loads(found.out)["programs"]), 2, found.err)

    def test_watches(self):
        program = self.copy("watched")
        output = self.folder / "report.json"
        watching = subprocess.Popen(["wine", EXE, "check", windows_path(program), "--watch", "--format", "json",
                                     "-o", windows_path(output)], env=wine.env, stdout=subprocess.DEVNULL,
                                    stderr=subprocess.DEVNULL)
        self.addCleanup(watching.wait)
        self.addCleanup(watching.kill)
        self.wait_for(lambda: output.exists() and output.stat().st_size > 0)
        before = output.read_bytes()
        program.write_bytes(b"G21 G90 G54\nG0 X0 Y0\nM30\n")
        self.wait_for(lambda: output.exists() and output.read_bytes() not in (b"", before))

    def wait_for(self, condition):
        end = time.monotonic() + PATIENCE  # clock: gives up on what hangs
        while not condition():
            self.assertLess(time.monotonic(), end)  # clock: as above
            time.sleep(0.1)  # clock: polls


class Pictures(Case):
    def test_shot(self):
        picture = self.folder / f"{ANY_SCRIPT}.png"
        self.windows("shot", JOBS[0][0], "--setup", JOBS[0][1], "--worst", "-o", windows_path(picture), status=0)
        self.assertTrue(picture.read_bytes().startswith(b"\x89PNG"))
        self.assertGreater(picture.stat().st_size, 20000)

    def test_html_report_has_pictures(self):
        report = self.folder / "report.html"
        self.windows("check", JOBS[0][0], "--setup", JOBS[0][1], "--format", "html", "-o", windows_path(report),
                     status=1)
        self.assertIn("data:image/", report.read_text(encoding="utf-8"))

    def test_window_opens(self):
        log = self.folder / "frames"
        window = subprocess.Popen(["wine", EXE, "view", JOBS[0][0], "--setup", JOBS[0][1], "--frame-log",
                                   windows_path(log)], cwd=SOURCE, env=wine.env, stderr=subprocess.PIPE)
        self.addCleanup(window.stderr.close)
        self.addCleanup(window.wait)
        self.addCleanup(window.kill)
        end = time.monotonic() + PATIENCE  # clock: gives up on what hangs
        while not log.exists() or log.read_text(encoding="utf-8").count("frame") < 3:
            self.assertIsNone(window.poll(), "the window has closed")
            self.assertLess(time.monotonic(), end)  # clock: as above
            time.sleep(0.1)  # clock: polls
        if "FEELER_PICTURES" in os.environ:
            subprocess.run(["import", "-window", "root", os.environ["FEELER_PICTURES"]], env=wine.env, check=True)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
