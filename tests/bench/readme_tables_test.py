#!/usr/bin/env python3
"""Tables of a page are replaced row by row."""

import unittest

from readme_tables import updated

PAGE = """# Page

| unit | cost |
|---|---|
| a | 1 |
| b | 2 |

| unit | other |
|---|---|
| a | 7 |

End.
"""


class Tables(unittest.TestCase):
    def test_rows_are_replaced_and_added_and_others_stay(self):
        text, missing = updated(PAGE, "something\n| unit | cost |\n|---|---|\n| b | 5 |\n| c | 6 |\n")
        self.assertEqual(missing, [])
        self.assertEqual(text, PAGE.replace("| b | 2 |\n", "| b | 5 |\n| c | 6 |\n"))

    def test_a_table_with_another_heading_is_reported(self):
        text, missing = updated(PAGE, "| unit | price |\n|---|---|\n| a | 5 |\n")
        self.assertEqual((text, missing), (PAGE, ["| unit | price |"]))

    def test_two_tables_at_once(self):
        text, _ = updated(PAGE, "| unit | cost |\n|---|---|\n| a | 3 |\n\n| unit | other |\n|---|---|\n| a | 8 |\n")
        self.assertIn("| a | 3 |\n| b | 2 |", text)
        self.assertIn("| unit | other |\n|---|---|\n| a | 8 |", text)

    def test_what_is_no_table_is_not_read(self):
        self.assertEqual(updated(PAGE, "| unit | cost |\nno rows\n"), (PAGE, []))


if __name__ == "__main__":
    unittest.main()
