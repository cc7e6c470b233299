"""Tests the output of batch_overhead.py for hand-calculated times, and the commands that it runs."""

import types
import unittest
from unittest import mock

import batch_overhead


class Table(unittest.TestCase):
    def test_ratios_are_to_the_checks_alone(self):
        least = {"starting": 2.0, "one by one": 22.0, "batch": 20.4, "with database": 21.0,
                 "with all reports": 25.0, "unchanged": 0.5}
        lines = batch_overhead.table(least)
        self.assertIn("20.00 s", lines[1])
        self.assertTrue(lines[2].endswith("+2.0 %"), lines[2])
        self.assertTrue(lines[4].endswith("+25.0 %"), lines[4])
        self.assertTrue(lines[5].endswith("-97.5 %"), lines[5])


class Ways(unittest.TestCase):
    def test_each_program_is_checked_once_by_itself_and_each_form_is_written(self):
        ways = batch_overhead.ways_of("feeler", "parts", ["a.nc", "b.nc"], ["--mesh-size", "1"], "/tmp")
        self.assertEqual([command[2] for command in ways["one by one"]], ["a.nc", "b.nc"])
        self.assertEqual(len(ways["starting"]), 2)
        written = ways["with all reports"][-1]
        for form in batch_overhead.FORMS:
            self.assertIn(form, written)
        self.assertNotIn("--cache", ways["batch"][0])


class CpuSeconds(unittest.TestCase):
    def test_they_are_those_of_what_was_started(self):
        # clock: given
        used = [types.SimpleNamespace(ru_utime=1.0, ru_stime=0.5), types.SimpleNamespace(ru_utime=3.0, ru_stime=0.75)]
        with mock.patch("resource.getrusage", side_effect=used) as asked:  # clock: replaced
            self.assertEqual(batch_overhead.cpu_seconds([["true"], ["false"]]), 2.25)  # clock: replaced
        asked.assert_called_with(batch_overhead.resource.RUSAGE_CHILDREN)


if __name__ == "__main__":
    unittest.main()
