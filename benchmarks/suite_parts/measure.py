# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Runs of tsar_refine and their scores, each stored when it is finished."""

import hashlib
import json
import os
import shutil
import tempfile
import time
from dataclasses import asdict
from pathlib import Path

from programs import CommandFailed, own_folder, run
from scoring import Scorer
from suite_parts.agreement import check_sparse, check_view_agreement
from suite_parts.harm import measure_truth
from suite_parts.maps import Maps
from suite_parts.outliers import measure_outliers
from suite_parts.plane_copies import check_true_planes
from suite_parts.planes import check_planes
from suite_parts.sparse_model import read_model
from suite_parts.surfaces import check_surfaces

DEPTH_TOLERANCES = (0.02, 0.05)
CLOUD_TOLERANCES = (0.02, 0.05, 0.1)
# Raised where the same maps would get other scores, or more of them.
VERSION = 5


def hash_of_file(path):
    found = shutil.which(str(path))
    if not found:
        raise CommandFailed(f"{path}: no such program; build it, or give "
                            "--program")
    return hashlib.sha256(Path(found).read_bytes()).hexdigest()


def write_json(path, value):
    """The file gets its name only once it is complete."""
    new = path.with_name(f"{path.name}.{os.getpid()}.new")
    new.write_text(json.dumps(value, indent=1) + "\n")
    new.replace(path)


class Measurer:
    """Scores workspaces, and stores what was scored below a folder."""

    def __init__(self, arguments):
        self.program = arguments.program
        self.colmap = arguments.colmap
        self.colmap_lib = arguments.colmap_lib
        self.fuse = not arguments.no_fusion
        self.device = arguments.device
        self.keep = arguments.keep
        self.program_hash = hash_of_file(self.program)
        self.runs = own_folder(arguments.results / "runs")

    def _stored(self, kind, key):
        """Where a result is, and the result if it exists; one with a cloud also
        serves where no cloud is asked for."""
        for with_cloud in (True, False) if not self.fuse else (True,):
            text = json.dumps([VERSION, kind, with_cloud, *key])
            digest = hashlib.sha256(text.encode()).hexdigest()[:24]
            path = self.runs / f"{digest}.json"
            if path.is_file():
                return path, json.loads(path.read_text())
        return path, None

    def _score(self, configuration, workspace, maps, folder, refined):
        """Scores of a workspace by itself, before or after refinement."""
        scene = configuration.path
        scores = {}
        if (scene / "ground_truth" / "depth").is_dir() or (
                scene / "scans" / "scan_alignment.mlp").is_file():
            scorer = Scorer(self.program, self.colmap, scene,
                            DEPTH_TOLERANCES, CLOUD_TOLERANCES,
                            self.colmap_lib)
            cloud = folder / "fused.ply" if self.fuse else None
            scores = scorer.score(workspace, cloud, maps.type)
            clouds = {"": cloud}
            if refined and self.fuse:
                clouds["tsar_fuse_"] = folder / "tsar_fused.ply"
                scores.update(scorer.score_tsar_fuse(
                    workspace, clouds["tsar_fuse_"], maps.type, self.device))
            if scorer.has_scans and self.fuse:
                for prefix, path in clouds.items():
                    found = check_surfaces(scorer.scans, path)
                    scores.update({f"{prefix}{key}": value
                                   for key, value in found.items()})
        model = read_model(workspace / "sparse")
        return {**scores, **measure_outliers(scene, maps),
                **check_sparse(model, maps)}, model

    def before(self, configuration, workspace, fingerprint):
        """Scores of the maps that refinement begins with, and how many true
        planes there are."""
        path, stored = self._stored("before", [fingerprint])
        if stored is None:
            maps = Maps(workspace)
            with tempfile.TemporaryDirectory(prefix="tsar_suite_") as folder:
                stored, model = self._score(configuration, workspace, maps,
                                            Path(folder), refined=False)
            stored.update(check_true_planes(configuration.path, model, maps))
            write_json(path, stored)
        return stored

    def find_run(self, fingerprint, options, seed):
        return self._stored("run", [self.program_hash, fingerprint, options,
                                    seed, self.device])

    def refine(self, configuration, workspace, fingerprint, variant, options,
               seed, words):
        """Refines with these options and scores the result; stores both.
        words: the options as the program is to get them."""
        path, _ = self.find_run(fingerprint, options, seed)
        with tempfile.TemporaryDirectory(prefix="tsar_suite_") as temporary:
            folder = Path(temporary)
            if self.keep:
                folder = own_folder(self.keep / (
                    f"{configuration.stem()}-{variant}-{seed}".replace(
                        " ", "_")))
            output = folder / "refined"
            # What an earlier run left there would be taken for finished work.
            shutil.rmtree(output, ignore_errors=True)
            command = [self.program, "tsar_refine", "--workspace_path",
                       workspace, "--output_path", output,
                       "--TsarRefine.device", self.device, *words]
            if seed:
                command += ["--TsarRefine.seed", seed]
            start = time.monotonic()
            run(command)
            seconds = time.monotonic() - start
            before = Maps(workspace)
            after = Maps(output, before.type)
            scores, model = self._score(configuration, output, after, folder,
                                        refined=True)
            scores.update(measure_truth(configuration.path, before, after))
            scores.update(check_view_agreement(model, after))
            scores.update(check_planes(configuration.path, model, after))
        record = {**{key: value for key, value in asdict(configuration).items()
                     if key != "path"}, "seed": seed, "options": options,
                  "program": self.program_hash, "device": self.device,
                  "seconds": seconds, "scores": scores}
        write_json(path, record)
        return record
