#!/usr/bin/env python3
"""Finds tests that read a clock, sleep or limit a time: their result may depend on how busy the machine is.
Count operations instead, or move the test to tests/speed.

    clocks.py ROOT            checks the tree at ROOT; prints each line found, exits with 1 if there is one
    clocks.py --self-check    checks this script against a small tree with known lines

A line is allowed if a comment on it, or alone on the line above, says why the test cannot fail on a slow
machine: `// clock: gives up after 2 min` or `# clock: ...`. Not checked: tests/speed, tests/cluster, which is
run by hand, and the benchmarks in tests/bench, but for their own tests.
"""
import pathlib
import re
import sys
import tempfile

ALLOWED = re.compile(r"(//|#) clock: \S")
ALLOWED_BELOW = re.compile(r"\s*(//|#) clock: \S")
COMMENT = {"//": re.compile(r"(^|\s)//.*"), "#": re.compile(r"(^|\s)#(\s.*)?$")}

# Commands of the shell, which also stand in strings of other languages.
COMMANDS = [r"\btimeout\s+(-\S+\s+([A-Z]+\s+)?)*[\d.]", r"\bdate\b.*\+\S*%", r"\bEPOCH(REALTIME|SECONDS)\b",
            r"\bsleep\s+[\d.\"$]"]
SHELL = [r"\bSECONDS\b", r"\btimeout\b", r"\bsleep\b", r"(^|[;&|]\s*)times?\s", r"\bread\b.*\s-t"]
CPP = [r"\b(steady|system|high_resolution|file|utc|tai|gps)_clock\b", r"\bnow\(\)", r"::clock\(",
       r"\bclock_gettime\b", r"\bgettimeofday\b", r"\btimespec_get\b",
       r"(^|::|[\s(])times?\((nullptr|NULL|0\)|&)", r"\bru_[us]time\b", r"\bcpu_seconds\b", r"\bStopwatch\b",
       r"seconds\(\)", r"\b(EXPECT|ASSERT)_(GT|GE|LT|LE|NEAR)\(.*\bseconds\b",
       r"\b(u|nano)?sleep(_for|_until)?\(", r"\bwait_(for|until)\(\s*\w*(lock|\d)", r"_timedwait\b",
       r"(^|[^\w])::poll\(", r"\balarm\(", r"\bsetitimer\b", r"\btimer(fd)?_create\b"]
PYTHON = [r"\bimport time\b", r"\bfrom time\b", r"\btime\.\w+\(", r"\bdatetime\b", r"\btimeit\b", r"\btimeout=",
          r"\bperf_counter", r"\bmonotonic\b", r"\bprocess_time\(", r"\.alarm\(", r"\bsetitimer\b",
          r"\bgetrusage\b", r"\bru_[us]time\b", r"\bos\.times\b", r"\bcpu_seconds\b",
          r"\bassert(Less|Greater)\w*\(.*seconds"]
SCRIPT = [r"\bDate\b", r"\bperformance\b", r"\bhrtime\b", r"\bconsole\.time", r"\bset(Timeout|Interval)\b",
          r"\bwaitForTimeout\b", r"\btimeout\b", r"\bset\w*Timeout\b"]
CMAKE = [r"\bTIMEOUT\s+\d{1,2}\b"]

LANGUAGES = {".h": ("//", CPP), ".cpp": ("//", CPP), ".mjs": ("//", SCRIPT), ".js": ("//", SCRIPT),
             ".sh": ("#", SHELL), ".py": ("#", PYTHON), ".txt": ("#", CMAKE), ".cmake": ("#", CMAKE)}


def is_checked(path):
    """Whether a file, named relative to the root, is part of a test of ./dev test."""
    folder, name = path.parts[1], path.name
    if folder in ("speed", "cluster") or (folder == "bench" and "_test." not in name):
        return False
    return path.suffix in LANGUAGES and (path.suffix != ".txt" or name == "CMakeLists.txt")


def reads_clock(line, above, suffix):
    comment, patterns = LANGUAGES[suffix]
    if ALLOWED.search(line) or ALLOWED_BELOW.match(above):
        return False
    code = COMMENT[comment].sub("", line)
    return any(re.search(pattern, code) for pattern in patterns + COMMANDS)


def findings(root):
    found = []
    for path in sorted((root / "tests").rglob("*")):
        file = path.relative_to(root)
        if not path.is_file() or not is_checked(file) or path == pathlib.Path(__file__).resolve():
            continue
        lines = path.read_text(encoding="utf-8").splitlines()
        found += [f"{file}:{number}: {line.strip()}"
                  for number, (above, line) in enumerate(zip([""] + lines, lines), 1)
                  if reads_clock(line, above, path.suffix)]
    return found


READING = {
    "a.cpp": ["auto t = std::chrono::steady_clock::now();", "using Clock = std::chrono::file_clock;",
              "auto t = Clock::now();", "time_t t = time(nullptr);", "auto t = std::time(NULL);",
              "auto t = ::clock();", "auto t = utc_clock::now();", "timespec_get(&t, TIME_UTC);", "times(&t);",
              "double t = usage.ru_stime.tv_sec;", "EXPECT_GT(row.paper.seconds, 0.0);", "::alarm(2);",
              "::poll(&input, 1, 1000);",
              "woken.wait_for(lock, 2s);", "woken.wait_until(lock, end);", "std::this_thread::sleep_for(pause);",
              "::usleep(100);", 'run("timeout -s HUP 0.2 env");', "while (watch.seconds() < 5.0)"],
    "a.py": ["import time", "from time import monotonic", "now = datetime.now()", "run(words, timeout=2)",
             "signal.setitimer(signal.ITIMER_VIRTUAL, 0.2)", "signal.alarm(20)", "usage.ru_utime"],
    "a.mjs": ["const t = new Date();", "const t = Date.now();", "await click({timeout: 500});",
              "setTimeout(go, 10);", "const t = performance.now();", "await page.waitForTimeout(300);"],
    "a.sh": ["end=$((SECONDS + 5))", "echo $SECONDS", "timeout 0.2 feeler", "date +%s", "sleep 1",
             "t=$EPOCHREALTIME", "time feeler", 'sleep "$pause"'],
    "CMakeLists.txt": ["set_tests_properties(a PROPERTIES TIMEOUT 20)"]}
HARMLESS = {
    "b.cpp": ["::usleep(100); // clock: the other process ends at any moment", "// A clock: time(nullptr)",
              "program.wait_for([&] { return true; });", "files.poll();", "double seconds = move.time();",
              "shard.seconds = 0.25;", 'fmt::print("G4 P2");'],
    "c.cpp": ["// clock: gives up after 2 min", "while (Clock::now() < end)"],
    "b.py": ["run(words, timeout=300)  # clock: gives up after 5 min", "# import time", "timing = 3"],
    "b.mjs": ["timeout: patience, // clock: 180 s", "const update = 1;"],
    "b.sh": ["sleep 0.1 # clock: until it has ended", "# sleep 1", "feeler check sleeping.nc"],
    "CMakeLists.txt": ["set_tests_properties(b PROPERTIES TIMEOUT 1800)"]}


def self_check():
    """Runs the check over a small tree: each reading line is found, and no other."""
    with tempfile.TemporaryDirectory() as name:
        root = pathlib.Path(name)
        for folder in ("app", "speed", "cluster", "bench", "harmless"):
            (root / "tests" / folder).mkdir(parents=True)
            for file, lines in (HARMLESS if folder == "harmless" else READING).items():
                (root / "tests" / folder / file).write_text("\n".join(lines))
        (root / "tests/bench/a_test.py").write_text("import time")
        found = findings(root)
    wanted = [f"tests/app/{file}:{number}: {line}" for file, lines in sorted(READING.items())
              for number, line in enumerate(lines, 1)] + ["tests/bench/a_test.py:1: import time"]
    assert found == wanted, sorted(set(found) ^ set(wanted))


def main(arguments):
    if arguments == ["--self-check"]:
        self_check()
        return 0
    found = findings(pathlib.Path(arguments[0] if arguments else ".").resolve())
    for line in found:
        print(line)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
