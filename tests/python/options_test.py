# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""The options of commands as keywords, without a workspace."""
import inspect
import json
import math
import re
import unittest

import colmap_tsar
from colmap_tsar import Workspace
from support import REPOSITORY, run_program

# What the workspace and other methods specify.
LEFT_OUT = {"workspace_path", "input_type", "project_path", "log_to_stderr", "log_level", "random_seed", "restore"}


class OptionsTest(unittest.TestCase):
    def test_keywords_are_the_options_of_the_commands(self):
        """Names, defaults and descriptions."""
        for method, command in (
            (colmap_tsar.refine, "tsar_refine"),
            (Workspace.refine, "tsar_refine"),
            (Workspace.stereo, "tsar_stereo"),
            (Workspace.fuse, "tsar_fuse"),
            (Workspace.import_maps, "tsar_import"),
            (Workspace.report, "tsar_report"),
        ):
            parameters = dict(inspect.signature(method).parameters)
            for option in json.loads(run_program(command, "--help_json"))["options"]:
                name = option["name"].split(".")[-1]
                if name in LEFT_OUT:
                    continue
                name = "pass_" if name == "pass" else name
                with self.subTest(command=command, option=name):
                    parameter = parameters.pop(name)
                    if parameter.default not in (None, inspect.Parameter.empty):
                        default = parameter.default
                        written = default if isinstance(default, str) else f"{default:g}"
                        self.assertEqual(written, f"{float(option['default']):g}"
                                         if option["value"] == "NUMBER" else option["default"])
                    self.assertIn(f"    {name}: ", method.__doc__)
            others = {"self", "workspace_path", "input_type", "priors", "progress"}
            self.assertLessEqual(set(parameters), others, command)

    def test_wrong_keywords_are_errors_that_name_them(self):
        for options, kind, text in (
            ({"num_thread": 3}, TypeError, r"^refine\(\) has no option 'num_thread'; did you mean num_th"),
            ({"unlike_any": 3}, TypeError, r"^refine\(\) has no option 'unlike_any'$"),
            ({"min_confidence": 1.5}, colmap_tsar.BadOptionError, "^min_confidence: '1.5' is not .*0 to 1"),
            ({"min_confidence": math.nan}, colmap_tsar.BadOptionError, "^min_confidence: "),
            ({"seed": -(10**30)}, colmap_tsar.BadOptionError, "^seed: "),
            ({"preset": "best"}, colmap_tsar.BadOptionError, "^preset: 'best'.*paper"),
            ({"num_iterations": 0}, colmap_tsar.BadOptionError, "^num_iterations: '0' is not .*1 to 10"),
            ({"scene_planes": 1}, TypeError, "^scene_planes: "),
            ({"scene_planes": "no"}, TypeError, "^scene_planes: "),
            ({"seed": 2.0}, TypeError, "^seed: "),
            ({"seed": True}, TypeError, "^seed: "),
            ({"min_confidence": "0.3"}, TypeError, "^min_confidence: "),
            ({"min_confidence": True}, TypeError, "^min_confidence: "),
            ({"preset": 3}, TypeError, "^preset: "),
            ({"mask_path": 3}, TypeError, "^mask_path: "),
        ):
            with self.subTest(options=options):
                with self.assertRaisesRegex(kind, text) as caught:
                    colmap_tsar.refine("nowhere", **options)
                self.assertNotIn("--", str(caught.exception))

    def test_version_is_the_projects(self):
        text = (REPOSITORY / "CMakeLists.txt").read_text()
        version = re.search(r"project\(ColmapTsar VERSION ([\d.]+)", text)[1]
        self.assertEqual(colmap_tsar.__version__, version)
        with_or_without = "with CUDA" if colmap_tsar.has_cuda else "without CUDA"
        self.assertEqual(
            run_program("--version"), f"colmap_tsar {version} ({with_or_without})\n"
        )


if __name__ == "__main__":
    unittest.main()
