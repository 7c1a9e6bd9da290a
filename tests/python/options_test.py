# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""RefineOptions, without a workspace."""
import copy
import inspect
import math
import pickle
import re
import unittest

import colmap_tsar
from colmap_tsar import RefineOptions
from support import REPOSITORY, run_program


def defaults_of_help():
    """Option and default, as the command's help prints them."""
    text = run_program("tsar_refine", "--help")
    return dict(re.findall(r"--TsarRefine\.(\w+) \S+ \(default: (\S+)\)", text))


def as_help_writes(value):
    return str(int(value)) if isinstance(value, bool) else f"{value:g}"


class OptionsTest(unittest.TestCase):
    def test_names_and_defaults_are_those_of_the_command(self):
        expected = defaults_of_help()
        refine = inspect.signature(colmap_tsar.refine).parameters
        self.assertEqual(expected.pop("preset"), "default")
        self.assertEqual(refine["shard"].default, "")  # The help shows no empty one.
        for name in ("device", "gpu_index", "num_threads", "cache_size", "pass"):
            name_here = "pass_" if name == "pass" else name
            default = refine[name_here].default
            written = default if isinstance(default, str) else f"{default:g}"
            self.assertEqual(expected.pop(name), written, name)
        values = RefineOptions().todict()
        self.assertEqual(
            {name: as_help_writes(value) for name, value in values.items()}, expected
        )
        self.assertEqual(list(values), list(expected), "the order of the help")

    def test_types_are_those_of_the_members(self):
        options = RefineOptions()
        self.assertIs(type(options.filter), bool)
        self.assertIs(type(options.num_iterations), int)
        self.assertIs(type(options.plane_tolerance), float)
        options.plane_tolerance = 3  # An int will do, but stays a float.
        self.assertIs(type(options.plane_tolerance), float)

    def test_keywords_attributes_and_update_set_the_same(self):
        options = RefineOptions(segment=False, num_iterations=3)
        self.assertIs(options.segment, False)
        self.assertEqual(options.num_iterations, 3)
        other = RefineOptions()
        other.segment = False
        other.num_iterations = 3
        self.assertEqual(options, other)
        self.assertEqual(
            options, RefineOptions().update(segment=False, num_iterations=3)
        )
        self.assertNotEqual(options, RefineOptions())
        self.assertNotEqual(options, "options")

    def test_unknown_names_are_errors_with_a_suggestion(self):
        with self.assertRaisesRegex(TypeError, "'num_iteration'.*num_iterations"):
            RefineOptions(num_iteration=3)
        options = RefineOptions()
        with self.assertRaisesRegex(AttributeError, "'segmnt'.*did you mean segment"):
            options.segmnt = False
        with self.assertRaisesRegex(AttributeError, "'segmnt'.*did you mean segment"):
            options.segmnt
        with self.assertRaisesRegex(AttributeError, "'unlike_any'.*help"):
            options.unlike_any = 1
        with self.assertRaises(AttributeError):
            del options.segment
        self.assertEqual(options, RefineOptions())

    def test_former_names_set_the_same_and_warn(self):
        with self.assertWarnsRegex(
                FutureWarning, "own_texture is called foreground_fattening now"):
            options = RefineOptions(own_texture=False)
        self.assertFalse(options.foreground_fattening)
        with self.assertWarns(FutureWarning):
            options.own_texture = True
        self.assertTrue(options.foreground_fattening)
        with self.assertWarns(FutureWarning):
            self.assertTrue(options.own_texture)
        self.assertNotIn("own_texture", options.todict())

    def test_values_out_of_range_name_the_option(self):
        for name, value in (
            ("num_iterations", 0),
            ("num_iterations", 11),
            ("num_iterations", 10**30),
            ("num_iterations", -(10**30)),
            ("confidence_weight", 1.5),
            ("confidence_weight", math.nan),
            ("plane_tolerance", math.inf),
        ):
            with self.subTest(name=name, value=value):
                with self.assertRaisesRegex(ValueError, f"^{name}: .* from ") as caught:
                    RefineOptions(**{name: value})
                self.assertIsInstance(caught.exception, colmap_tsar.BadOptionError)
                self.assertEqual(caught.exception.code, "bad_option")
                options = RefineOptions()
                with self.assertRaises(colmap_tsar.BadOptionError):
                    setattr(options, name, value)
                self.assertEqual(options, RefineOptions())

    def test_both_ends_of_a_range_are_inside(self):
        for value in (1, 10):
            self.assertEqual(RefineOptions(num_iterations=value).num_iterations, value)

    def test_values_of_another_type_are_type_errors(self):
        for name, value in (
            ("segment", 1),
            ("segment", "no"),
            ("segment", None),
            ("num_iterations", 2.0),
            ("num_iterations", True),
            ("num_iterations", "2"),
            ("plane_tolerance", "7"),
            ("plane_tolerance", True),
            ("plane_tolerance", None),
        ):
            with self.subTest(name=name, value=value):
                with self.assertRaisesRegex(TypeError, f"^{name}: "):
                    RefineOptions(**{name: value})

    def test_update_sets_all_or_nothing(self):
        options = RefineOptions()
        with self.assertRaises(ValueError):
            options.update(segment=False, num_iterations=0)
        self.assertEqual(options, RefineOptions())

    def test_check_finds_contradictions(self):
        options = RefineOptions(
            filter_confidence=False, filter_discontinuity=False, view_agreement=False
        )
        with self.assertRaisesRegex(colmap_tsar.BadOptionError, "^filter: nothing"):
            options.check()
        options.filter = False
        options.check()

    def test_paper_takes_options_on_top(self):
        paper = RefineOptions.paper()
        self.assertNotEqual(paper, RefineOptions())
        self.assertIs(paper.scene_planes, False)
        self.assertIs(paper.cost_ratio, False)
        self.assertIs(RefineOptions.paper_strict().cost_ratio, True)
        changed = RefineOptions.paper(num_iterations=2)
        self.assertEqual(changed.num_iterations, 2)
        self.assertEqual(changed.update(num_iterations=paper.num_iterations), paper)

    def test_copies_are_equal_and_independent(self):
        options = RefineOptions.paper(num_iterations=2)
        for copied in (
            options.copy(),
            copy.copy(options),
            copy.deepcopy(options),
            pickle.loads(pickle.dumps(options)),
            RefineOptions(**options.todict()),
            eval(repr(options)),
        ):
            self.assertEqual(copied, options)
            copied.num_iterations = 1
            self.assertNotEqual(copied, options)
            self.assertEqual(options.num_iterations, 2)
        options.todict()["num_iterations"] = 9
        self.assertEqual(options.num_iterations, 2)

    def test_every_option_is_explained(self):
        for name in RefineOptions().todict():
            doc = getattr(RefineOptions, name).__doc__
            self.assertRegex(doc, r"default \S")
            self.assertIn(f"{name}: ", RefineOptions.__doc__)
            self.assertIn(name, dir(RefineOptions()))
            self.assertIn(name, inspect.signature(RefineOptions).parameters)

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
