"""Tests feed_limit.py with hand-written reports."""

import json
import math
import os
import random
import stat
import subprocess
import sys
import tempfile
import unittest

import feed_limit


def block(number, **what):
    known = {"block": number, "line": number + 5, "segments": 10, "cycles": 1000, "asked": 0.0,
             "permitted": 0.1, "due": 1.0, "entered": float(number), "slack": 0.9} | what
    return {"interval": known["cycles"]} | known


def report(blocks, look_ahead=2, taken=None, host_lines=0):
    return {"config": {"device": {"clock_mhz": 100, "host_cycles_per_line": 4},
                       "control": {"look_ahead": look_ahead}},
            "counters": {"host_lines": host_lines},
            "totals": {"missed": sum(1 for b in blocks if (b["slack"] or 0.0) < 0.0),
                       "taken": taken if taken is not None else float(len(blocks))},
            "blocks": blocks}


class Bracket(unittest.TestCase):
    def test_it_closes_in_on_the_limit_from_both_sides(self):
        asked = []

        def keeps_up(override):
            asked.append(override)
            return override < 37.0

        kept, missed = feed_limit.bracket(keeps_up, most=1000.0)
        self.assertLess(kept, 37.0)
        self.assertGreaterEqual(missed, 37.0)
        self.assertLessEqual(missed, 1.05 * kept)
        self.assertEqual(len(asked), len(set(asked)))

    def test_what_is_late_as_programmed_says_so(self):
        self.assertEqual(feed_limit.bracket(lambda override: False), (0.0, 1.0))

    def test_what_is_never_late_has_no_limit(self):
        self.assertEqual(feed_limit.bracket(lambda override: True, most=10.0), (10.0, None))

    def test_nothing_beyond_the_greatest_override_is_tried(self):
        asked = []
        kept, missed = feed_limit.bracket(lambda override: asked.append(override) or override < 9.5,
                                          most=10.0)
        self.assertTrue(kept < 9.5 <= missed <= 10.0)
        self.assertEqual(max(asked), 10.0)


class Reports(unittest.TestCase):
    def test_the_first_late_block_is_the_first_below_no_slack(self):
        blocks = [block(0, slack=None), block(1), block(2, slack=-0.1), block(3, slack=-5.0)]
        self.assertEqual(feed_limit.first_late(report(blocks))["block"], 2)
        self.assertIsNone(feed_limit.first_late(report(blocks[:2])))

    def test_a_feed_counts_for_more_than_a_rapid_of_the_same_block(self):
        commands = [{"block": 1, "command": "select_plane"},
                    {"block": 2, "command": "straight_traverse"},
                    {"block": 3, "command": "straight_traverse"},
                    {"block": 3, "command": "straight_feed", "feed": 200},
                    {"block": 3, "command": "straight_traverse"},
                    {"block": 4, "command": "arc_feed", "feed": 500.5}]
        trace = "\n".join(json.dumps(command) for command in commands)
        self.assertEqual(feed_limit.feeds(trace), {2: "rapid", 3: 200, 4: 500.5})

    def test_without_braking_the_slowest_stretch_counts(self):
        # A second and 10 us a block, but the fourth takes 1 ms and has 0.5 s.
        blocks = [block(0), block(1), block(2, entered=2.0), block(3, cycles=100_000, entered=2.5),
                  block(4, entered=3.5), block(5, entered=4.5)]
        # With all asked for at the start, 2.5 s are left for blocks 1 to 3.
        override, late = feed_limit.without_braking(report(blocks, look_ahead=100))
        self.assertAlmostEqual(override, 2.5 / 1.02e-3)
        self.assertEqual(late["block"], 3)
        # Asked for one block before, block 3 has the time of block 2.
        override, late = feed_limit.without_braking(report(blocks, look_ahead=1))
        self.assertAlmostEqual(override, 0.5 / 1e-3)
        self.assertEqual(late["block"], 3)

    def test_without_braking_is_what_a_queue_does(self):
        for seed in range(40):
            rng = random.Random(seed)
            blocks, entered = [], 0.001
            for i in range(30):
                cycles = rng.randrange(1000, 200_000)
                blocks.append(block(i, cycles=cycles, interval=rng.randrange(100, cycles),
                                    entered=entered if rng.random() < 0.8 else None))
                entered += rng.uniform(0.01, 2.0)
            ahead = rng.randrange(5, 9)  # so that something moves within it
            override, late = feed_limit.without_braking(report(blocks, look_ahead=ahead))
            self.assertEqual(self.late_in_queue(blocks, ahead, 0.999 * override), [])
            self.assertIn(late["block"], self.late_in_queue(blocks, ahead, 1.001 * override))

    @staticmethod
    def late_in_queue(blocks, ahead, override):
        """The blocks that the device permits after they are reached, block by block."""
        moving = [i for i, b in enumerate(blocks) if b["entered"] is not None]
        begin = blocks[moving[0]]["entered"]

        def permits(start):
            permitted = 0.0
            for i, each in enumerate(blocks):
                enters = next((k for k in moving if k >= i - ahead), moving[-1])
                asked = 0.0
                if enters != moving[0]:
                    asked = start + (blocks[enters]["entered"] - begin) / override
                permitted = max(permitted + each["interval"] / 1e8, asked + each["cycles"] / 1e8)
                yield permitted

        start = list(permits(0.0))[moving[0]]
        permitted = list(permits(start))
        return [i for i in moving[1:]
                if permitted[i] > start + (blocks[i]["entered"] - begin) / override]

    def test_blocks_that_do_not_move_are_never_late(self):
        blocks = [block(0), block(1, entered=None, cycles=0), block(2)]
        self.assertAlmostEqual(feed_limit.without_braking(report(blocks))[0], 2.0 / 1e-5)
        self.assertEqual(feed_limit.without_braking(report(blocks[:2])), (math.inf, None))

    def test_the_host_brings_a_line_in_so_many_cycles(self):
        blocks = [block(0), block(1, cycles=1800)]
        cycles = sum(each["interval"] for each in blocks)
        self.assertAlmostEqual(feed_limit.host_share(report(blocks, host_lines=100)), 400 / cycles)
        self.assertEqual(feed_limit.host_share(report(blocks, host_lines=cycles)), 1.0)

    def test_the_reason_is_the_look_ahead_the_control_a_crowd_the_block_or_those_before_it(self):
        late = {"slack": -0.5, "due": 0.5, "permitted": 1.0}
        # The control reads block 3 when the machine enters block 1.
        whole = report([block(0), block(1, entered=0.6), block(2), block(3)])
        self.assertIn("look-ahead", feed_limit.reason(whole, block(3, **late, asked=0.7)))
        whole["blocks"][1]["entered"] = 0.1
        self.assertIn("control", feed_limit.reason(whole, block(3, **late, asked=0.7)))
        self.assertIn("control", feed_limit.reason(whole, block(1, **late, asked=0.5)))
        self.assertIn("itself", feed_limit.reason(whole, block(1, **late, asked=0.1, cycles=60e6)))
        self.assertIn("before it", feed_limit.reason(whole, block(1, **late, asked=0.1, cycles=1e6)))
        crowd = [block(i, **late, asked=0.1) for i in range(3)] + [block(3)]
        self.assertIn("3 blocks due at once", feed_limit.reason(report(crowd), crowd[1]))


FAKE = f"""#!{sys.executable}
import json, re, sys
if sys.argv[1] == "trace":
    print(json.dumps({{"block": 1, "command": "straight_feed", "feed": 300}}))
    sys.exit(0)
assert "--past-refusals" in sys.argv and "--no-fit" in sys.argv
config = open(sys.argv[sys.argv.index("--config") + 1]).read()
override = float(re.search(r"feed_override = (.*)", config).group(1))
assert "elements = 3" in config
late = override > 6.0
first = {{"block": 0, "line": 6, "segments": 5, "cycles": 600, "interval": 600, "asked": 0.0, "permitted": 0.1,
         "due": None, "entered": 0.0, "slack": None}}
block = {{"block": 1, "line": 7, "segments": 5, "cycles": 600, "interval": 600, "asked": 0.0, "permitted": 0.2,
         "due": 0.1 if late else 0.3, "entered": 6.0, "slack": -0.1 if late else 0.1}}
print(json.dumps({{"config": {{"device": {{"clock_mhz": 100, "host_cycles_per_line": 4}},
                             "control": {{"look_ahead": 256}}}}, "counters": {{"host_lines": 141}},
                  "totals": {{"missed": int(late), "taken": 9.0}}, "blocks": [first, block]}}))
sys.exit(1 if late else 0)
"""


class Program(unittest.TestCase):
    def test_a_row_comes_from_the_runs_of_feeler(self):
        with tempfile.TemporaryDirectory() as folder:
            feeler, device = os.path.join(folder, "feeler"), os.path.join(folder, "device.toml")
            with open(feeler, "w", encoding="utf-8") as file:
                file.write(FAKE)
            os.chmod(feeler, stat.S_IRWXU)
            with open(device, "w", encoding="utf-8") as file:
                file.write("[device]\nelements = 3\n")
            done = subprocess.run([sys.executable, feed_limit.__file__, feeler, folder, "--only",
                                   "parallel", "--config", device],
                                  capture_output=True, text=True, check=True)
        cells = [cell.strip() for cell in done.stdout.splitlines()[-1].strip("|").split("|")]
        self.assertEqual(cells[0], "`parallel`")
        self.assertEqual(cells[1:5], ["47 %", "1000000", "300000000", "7"])
        self.assertTrue(6.0 < float(cells[5]) <= 6.3)
        self.assertAlmostEqual(float(cells[6]), 300.0 * float(cells[5]), delta=20.0)
        self.assertEqual(cells[7:], ["7", "device: the blocks before it"])

    def test_a_run_that_fails_ends_it(self):
        with tempfile.TemporaryDirectory() as folder:
            feeler = os.path.join(folder, "feeler")
            with open(feeler, "w", encoding="utf-8") as file:
                file.write("#!/bin/sh\necho the reason >&2\nexit 2\n")
            os.chmod(feeler, stat.S_IRWXU)
            with self.assertRaisesRegex(SystemExit, "the reason"):
                feed_limit.Job(feeler, folder, "none.nc", "none").run("trace")

    def test_every_job_is_there(self):
        assets = os.path.join(os.path.dirname(feed_limit.__file__), "..", "..", "assets")
        for program, setup in feed_limit.JOBS:
            self.assertTrue(os.path.exists(os.path.join(assets, "programs", program)))
            self.assertTrue(os.path.exists(os.path.join(assets, "setups", setup + ".toml")))


if __name__ == "__main__":
    unittest.main()
