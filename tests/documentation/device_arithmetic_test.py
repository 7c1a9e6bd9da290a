#!/usr/bin/env python3
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""A CPU and a GPU compute the same bits: code for both calls no function that
their libraries, or their instructions, round differently. Addition,
multiplication, division and square root are rounded alike everywhere; what else
is needed consists of these, or has a form for each, in base/arithmetic.h."""
import os
import re

from library_sources import library_sources
from sample_testing import check, parse_arguments

args = parse_arguments("repository")

FUNCTIONS = (
    "exp|exp2|exp10|expm1|log|log2|log10|log1p|pow|powi|sin|cos|tan|sincos|sinpi|cospi|"
    "sincospi|asin|acos|atan|atan2|sinh|cosh|tanh|asinh|acosh|atanh|cbrt|rcbrt|rsqrt|hypot|"
    "rhypot|norm3d|norm4d|rnorm3d|rnorm4d|fma|erf|erfc|erfinv|erfcinv|normcdf|normcdfinv|"
    "tgamma|lgamma|j0|j1|y0|y1")
# As C names those of floats; what only host code calls has std:: and no f.
OF_FLOATS = re.compile(rf"\b(?:{FUNCTIONS})f\s*\(")
# Also those that take any type, and CUDA's intrinsics, such as __expf,
# __fdividef and __fmaf_rn.
OF_ANY_TYPE = re.compile(
    rf"\b(?:{FUNCTIONS})f?\s*\(|"
    r"\b__(?:exp|exp10|log|log2|log10|pow|sin|cos|tan|sincos|saturate|fdivide)f\s*\(|"
    r"\b__[fd](?:ma|maf|add|sub|mul|div|rcp|sqrt|rsqrt)f?_(?:rn|rz|ru|rd)\s*\(")
# Where a CPU computes the same in another way.
EXACT = {("base/arithmetic.h", "__fmaf_rn(")}
MARK = re.compile(r"\bTSAR_HD\b|\b__device__|\b__global__")


def without_comments(source):
    return re.sub(r"//[^\n]*|/\*.*?\*/", "", source, flags=re.DOTALL)


def marked_functions(source):
    """The texts of the functions for both devices, from their marks on."""
    for mark in MARK.finditer(source):
        depth = 0
        for i in range(mark.end(), len(source)):
            character = source[i]
            depth += (character in "({") - (character in ")}")
            if depth > 0:
                continue
            # The end of a declaration or of the body; what ends a member's
            # initializer is followed by the next one or by the body.
            if character == ";" or character == "}" and not re.match(
                    r"\s*[,{]", source[i + 1:]):
                yield source[mark.start():i + 1]
                break


def violations(name, source):
    """The calls of such functions in a file of this name."""
    source = without_comments(source)
    found = set()
    if name.endswith((".cu", ".cuh")) or MARK.search(source):
        found.update(OF_FLOATS.findall(source))
    for function in marked_functions(source):
        found.update(OF_ANY_TYPE.findall(function))
    return sorted(found)


# Shows that the rule finds what it should and nothing else; %s stand for what a
# kernel and what the host computes.
KERNEL = """
struct FadeKernel {
  ImageView<float> image;
  TSAR_HD explicit FadeKernel(const Views& views) : image{views.image}, scale(2.f) {}
  TSAR_HD float Scale() const;
  TSAR_HD void operator()(int x, int y) const {
    if (x > 0) {
      image(x, y) = %s;
    }
  }
};
float TableEntry(int i) { return %s; }
"""
FORBIDDEN = ("expf(-x)", "std::exp(-x)", "exp (-x)", "__expf(-x)", "rsqrtf(x)",
             "fmaf(x, y, 1.f)", "__fmaf_rn(x, y, 1.f)", "std::pow(x, 2.f)", "cos(x)",
             "std::hypot(x, y)", "atan2f(y, x)", "__fdividef(x, y)")
ALLOWED = ("sqrtf(x)", "fminf(x, y)", "fabsf(x)", "floorf(x)", "x / y", "ExpOfNegative(-x)",
           "1.f  // Not expf(x).", "norm(x)", "view.log_scale")
missed = [call for call in FORBIDDEN for suffix in ("cu", "cuh", "h")
          if not violations(f"fade.{suffix}", KERNEL % (call, "0.f"))]
check(not missed, "calls are seen in kernels of any file"
      + "".join(": " + call for call in missed))
wrong = [call for call in ALLOWED if violations("fade.cu", KERNEL % (call, "std::exp(0.1f * i)"))]
check(not wrong, "what all round alike is allowed, and std::exp on the host"
      + "".join(": " + call for call in wrong))
check(violations("fade.cuh", "inline float Fade(float x) { return expf(x); }"),
      "expf is seen in any function of a file for both devices")
check(violations("fade.cu", "void Run() { For([=] TSAR_HD(int i) { a[i] = sin(a[i]); }); }"),
      "a lambda expression is a function too")
check(not violations("fade.cc", "float Fade(float x) { return expf(x) * std::pow(x, 2.f); }"),
      "code for the host alone calls what it likes")

num_marked = 0
broken = []
for name, source in library_sources(args.repository):
    num_marked += sum(1 for _ in marked_functions(without_comments(source)))
    broken += [f"{name}: {call})" for call in violations(name, source)
               if (name, call) not in EXACT]
check(num_marked > 100, f"{num_marked} functions for both devices were read")
check(not broken, "they call nothing that a CPU and a GPU round differently"
      + "".join("\n  " + line for line in broken))

with open(os.path.join(args.repository, "cmake", "TsarTargets.cmake"), encoding="utf-8") as file:
    flags = file.read()
check("-ffp-contract=off" in flags and "-fmad=false" in flags,
      "neither compiler fuses multiplications with additions by itself")
check(not re.search(r"fast.math|prec-(div|sqrt)=false", flags),
      "neither takes short cuts in divisions and roots")
