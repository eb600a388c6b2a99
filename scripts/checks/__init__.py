"""Independent measurements of written glTF files: one module for each tool, each run in a process of its own.

Every module is called as `python -m checks.TOOL OUT.json FILE...` and writes one `finding.Measured` for
each file. None of them shares code with Kiln; none of them judges. `scripts/verify.py` holds what they find
against what the report claims.
"""
