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

# What the workspace and other methods say.
LEFT_OUT = {"workspace_path", "input_type", "project_path", "log_to_stderr", "random_seed", "restore"}


def options_of(command):
    return json.loads(run_program(command, "--help_json"))["options"]


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
            (Workspace.export, "tsar_export"),
        ):
            parameters = dict(inspect.signature(method).parameters)
            for option in options_of(command):
                name = option["name"].split(".")[-1]
                if name in LEFT_OUT:
                    continue
                name = "pass_" if name == "pass" else name
                with self.subTest(command=command, option=name):
                    parameter = parameters.pop(name)
                    if parameter.default not in (None, inspect.Parameter.empty):
                        default = parameter.default
                        written = default if isinstance(default, str) else f"{default:g}"
                        self.assertEqual(written, option["default"])
                    self.assertIn(f"    {name}: ", method.__doc__)
                    for setting in option.get("settings", ()):
                        self.assertIn(f"    {setting['name']}: ", method.__doc__)
            others = {"self", "workspace_path", "input_type", "priors", "progress"}
            self.assertLessEqual(set(parameters), others, command)

    def expect_error(self, kind, text, **options):
        with self.assertRaisesRegex(kind, text) as caught:
            colmap_tsar.refine("nowhere", **options)
        self.assertNotIn("--", str(caught.exception))

    def test_unknown_names_are_errors_with_a_suggestion(self):
        for options, text in (
            ({"num_thread": 3}, r"^refine\(\) has no option 'num_thread'; did you mean num_th"),
            ({"unlike_any": 3}, r"^refine\(\) has no option 'unlike_any'; see its help"),
            ({"experiment": {"segmnt": False}}, "^experiment has no option 'segmnt'.*segment"),
        ):
            self.expect_error(TypeError, text, **options)
        self.expect_error(
            colmap_tsar.BadOptionError, "'segmnt'; did you mean segment.*help", experiment="segmnt=0"
        )

    def test_values_out_of_range_name_the_option(self):
        for options, text in (
            ({"min_confidence": 1.5}, "^min_confidence: 1.5 is too large"),
            ({"min_confidence": math.nan}, "^min_confidence: "),
            ({"seed": -(10**30)}, "^seed: "),
            ({"preset": "best"}, "^preset: 'best'.*paper"),
            ({"experiment": {"num_iterations": 0}}, "^experiment num_iterations: 0 is too"),
            ({"experiment": "num_iterations=11"}, "^experiment num_iterations: 11 is too"),
            ({"experiment": {"plane_tolerance": math.inf}}, "^experiment plane_tolerance: "),
        ):
            with self.subTest(options=options):
                self.expect_error(colmap_tsar.BadOptionError, text, **options)

    def test_values_of_another_type_are_type_errors(self):
        for options in (
            {"scene_planes": 1},
            {"scene_planes": "no"},
            {"seed": 2.0},
            {"seed": True},
            {"min_confidence": "0.3"},
            {"min_confidence": True},
            {"experiment": {"segment": 1}},
            {"experiment": {"num_iterations": "2"}},
        ):
            with self.subTest(options=options):
                (name, value), = options.items()
                name = next(iter(value)) if isinstance(value, dict) else name
                self.expect_error(TypeError, f"^{name}: ", **options)

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
