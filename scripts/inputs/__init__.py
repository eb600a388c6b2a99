"""Makers of the gallery's own inputs: `python scripts/inputs/make.py` writes them into specs/inputs.

Only the standard library, and only arithmetic that is exact or correctly rounded (no sines, no powers), so
that every machine makes the same pictures and the same cage.
"""
