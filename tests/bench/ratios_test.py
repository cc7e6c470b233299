"""Tests the output of ratios.py for a hand-written run."""

import copy
import json
import os
import subprocess
import sys
import tempfile
import unittest

import ratios

POSES = {"gap-1": 1.0, "gap-2": 4.0}  # times as long: their geometric mean is 2


def benchmark(row, pose, contestant, cpu_time, wall=1.0, unit="us", index=0):
    return {"name": f"{row}/{pose}/{contestant}/repeats:3/process_time", "run_type": "iteration",
            "repetition_index": index, "cpu_time": cpu_time, "real_time": wall, "time_unit": unit}


def canned():
    """The fast engine takes 2 us over h1, 4 over h0.5; the paper's 20 and 60; FCL 18 and 40."""
    data = {"context": {"challenger": "fast", "cpu": "A Processor", "cores": "2",
                        "fcl": "0.7.0", "host_name": "somebody's", "executable": "/somewhere/feeler_bench"},
            "benchmarks": []}
    times = {"spheres-h1": {"fast": 1.0, "paper": 10.0, "fcl": 9.0},
             "spheres-h0.5": {"fast": 2.0, "paper": 30.0, "fcl": 20.0},
             "flat-aligned": {"fast": 3.0, "paper": 303.0}}
    for row, contestants in times.items():
        for contestant, time in contestants.items():
            for pose, factor in POSES.items():
                for index, noise in enumerate((1.0, 0.5, 70.0)):
                    data["benchmarks"].append(
                        benchmark(row, pose, contestant, time * factor * noise, index=index))
    for index in range(3):
        data["benchmarks"].append(benchmark("build-h1", "A", "fast", 6.0, unit="ms", index=index))
    return data


def whole():
    data = {"context": canned()["context"], "benchmarks": []}
    for row in ([f"{start}-{size}" for start, _, _, _ in ratios.ABSOLUTE for size in ratios.SIZES]
                + [row for row, _ in ratios.FLAT] + list(ratios.OTHERS)):
        for contestant, time in (("fast", 1.0), ("paper", 2000.0)):
            data["benchmarks"].append(benchmark(row, "gap-1", contestant, time))
    return data


def line_of(text, start):
    return [line for line in text.splitlines() if line.startswith(start)][0].split()


class Ratios(unittest.TestCase):
    def setUp(self):
        self.results = ratios.Results(canned())
        self.text = ratios.report(self.results)

    def test_a_figure_is_the_geometric_mean_of_medians(self):
        self.assertAlmostEqual(self.results.figure("spheres-h1", "fast"), 2.0)
        self.assertAlmostEqual(self.results.figure("spheres-h0.5", "paper"), 60.0)

    def test_a_ratio_is_their_time_over_ours(self):
        self.assertAlmostEqual(self.results.ratio("spheres-h1", "paper"), 10.0)
        self.assertAlmostEqual(self.results.ratio("spheres-h0.5", "paper"), 15.0)
        self.assertAlmostEqual(self.results.ratio("spheres-h1", "fcl"), 9.0)

    def test_the_table_shows_ratios_beside_targets(self):
        self.assertEqual(line_of(self.text, "times faster than the paper's engine"),
                         "times faster than the paper's engine 10.0 (9) 15.0! (25) - (100)".split())
        self.assertEqual(line_of(self.text, "times faster than FCL"),
                         "times faster than FCL 9.00! (10) 10.0 (8) - (10)".split())
        self.assertEqual(line_of(self.text, "cold"),
                         "cold, us a query 2.00 (15) 4.00 (25) - (110)".split())
        self.assertEqual(line_of(self.text, "build, ms"),
                         "build, ms a body 6.00! (5) - (15) - (500)".split())

    def test_missed_targets_are_named_and_others_are_not(self):
        self.assertIn("3 of 8 targets missed:", self.text)
        self.assertIn("times faster than the paper's engine, h = 0.5: 15.0, aimed at 25", self.text)
        self.assertIn("times faster than FCL, h = 1: 9.00, aimed at 10", self.text)
        self.assertIn("build, ms a body, h = 1: 6.00, aimed at 5", self.text)
        self.assertNotIn("FCL, h = 0.5:", self.text)

    def test_a_contestant_without_all_poses_has_no_figure(self):
        data = canned()
        data["benchmarks"] = [run for run in data["benchmarks"]
                              if not run["name"].startswith("spheres-h1/gap-2/fcl")]
        self.assertIsNone(ratios.Results(data).ratio("spheres-h1", "fcl"))

    def test_peers_that_were_not_found_are_named(self):
        self.assertIn("Not found when this was built, so a dash below: nanoflann, Embree.",
                      self.text)
        data = canned()
        data["context"].update(nanoflann="1.4.2", embree="3.13.5")
        self.assertNotIn("Not found", ratios.report(ratios.Results(data)))

    def test_the_best_are_the_fastest_repetitions(self):
        best = ratios.Results(canned(), best=True)
        self.assertAlmostEqual(best.figure("spheres-h1", "fast"), 1.0)
        self.assertIn("fastest of repetitions", ratios.report(best))

    def test_time_on_the_wall_does_not_count(self):
        data = canned()
        for run in data["benchmarks"]:
            run["real_time"] = 1e6
        self.assertEqual(ratios.report(ratios.Results(data)), self.text)

    def test_poses_in_turn_are_no_pose_of_the_mean(self):
        data = canned()
        data["benchmarks"].append(benchmark("spheres-h1", "in-turn", "fast", 7.5))
        text = ratios.report(ratios.Results(data))
        self.assertIn("The gaps of h = 1 in turn take 1.50 times as long", text)
        self.assertEqual(line_of(text, "cold"), line_of(self.text, "cold"))

    def test_a_kept_run_says_the_same_and_names_no_host(self):
        data = canned()
        text = ratios.kept(ratios.Results(copy.deepcopy(data)))
        for best in (False, True):
            self.assertEqual(ratios.report(ratios.Results(json.loads(text), best)),
                             ratios.report(ratios.Results(copy.deepcopy(data), best)))
        self.assertIn("A Processor", text)
        self.assertNotIn("somewhere", text)
        self.assertNotIn("somebody", text)

    def test_only_a_whole_run_is_kept(self):
        for data, status in ((canned(), 1), (whole(), 0)):
            with tempfile.TemporaryDirectory() as folder:
                source, target = os.path.join(folder, "run.json"), os.path.join(folder, "kept.json")
                with open(source, "w", encoding="utf-8") as file:
                    json.dump(data, file)
                ran = subprocess.run([sys.executable, ratios.__file__, source, "--keep", target],
                                     capture_output=True, check=False)
                self.assertEqual(ran.returncode, status)
                self.assertEqual(os.path.exists(target), status == 0)


if __name__ == "__main__":
    unittest.main()
