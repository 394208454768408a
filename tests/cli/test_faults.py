"""The list of planted faults: each still finds its text, once, in the sources. Whether they are
caught takes a build each and stands behind the label long."""
import sys
import unittest

import cli_case

sys.path.insert(0, str(cli_case.ROOT / "tests" / "mutations"))
import mutations  # noqa: E402


class Faults(unittest.TestCase):
    def test_each_text_stands_once(self):
        for fault in mutations.FAULTS:
            with self.subTest(fault.name):
                text = (cli_case.ROOT / fault.file).read_text()
                self.assertEqual(text.count(fault.old), 1)
                self.assertNotEqual(fault.old, fault.new)


if __name__ == "__main__":
    cli_case.main()
