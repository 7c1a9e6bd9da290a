#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Prints two results of `colmap_tsar tsar_evaluate cloud --json 1` as a table.

  compare_scores.py BEFORE.json AFTER.json
"""
import json
import sys


def read(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    before, after = map(read, sys.argv[1:])
    print(f"{'':<24}{'before':>10}{'after':>10}")
    print(f"{'points':<24}{before['num_points']:>10}{after['num_points']:>10}")
    for old, new in zip(before["scores"], after["scores"]):
        for name in ("completeness", "accuracy", "f1"):
            label = f"{name} at {100 * old['tolerance']:g} cm"
            print(f"{label:<24}{old[name]:>10.3f}{new[name]:>10.3f}")


if __name__ == "__main__":
    main()
