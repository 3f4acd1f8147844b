"""Files held against the CF conventions, by a checker of others."""

import subprocess
import sys

CHECK = """
import sys
from compliance_checker.runner import CheckSuite, ComplianceChecker
CheckSuite.load_all_available_checkers()
for path in sys.argv[1:]:
    passed, failed = ComplianceChecker.run_checker(
        path, ["cf:1.11"], 0, "normal", output_filename="-", output_format="text"
    )
    assert passed and not failed, path
"""


def assert_in_conventions(*paths):
    """No error, no warning, no recommendation of the checker's is left."""
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", CHECK, *map(str, paths)],
        capture_output=True, text=True, check=False, timeout=300,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
