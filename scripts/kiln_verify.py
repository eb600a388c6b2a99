"""The command `kiln-verify` of the installed package: what `scripts/verify.py` is in the tree.

    kiln-verify out            every NAME.glb under out/ is held against its NAME.report.json
    kiln-verify --install      fetches the two tools that npm has, the Khronos validator and three.js (once, needs npm)

The modules beside this one are those of the tree, which find one another by their folder; so does this one.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent


def main() -> int:
    """Verify what the command line names; returns the exit code."""
    sys.path.insert(0, str(HERE))
    if sys.argv[1:] == ["--install"]:
        return install()
    import verify

    return verify.main()


def install() -> int:
    """Fetch the packages that the lock file names into the folder of this package."""
    words = ["npm", "ci", "--prefix", str(HERE), "--omit=dev", "--no-audit", "--no-fund", "--ignore-scripts"]
    try:
        return subprocess.run(words, check=False).returncode
    except FileNotFoundError:
        print("kiln-verify: npm is missing; install Node.js", file=sys.stderr)
        return 1
