# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Depth maps and clouds of a workspace against a scene's ground truth."""

import json

from programs import CommandFailed, colmap_environment, run


def comma_list(numbers):
    return ",".join(f"{number:g}" for number in numbers)


class Scorer:
    """Scores one workspace against a scene's ground truth."""

    def __init__(self, program, colmap, scene, depth_tolerances,
                 cloud_tolerances, colmap_lib=None):
        self.program = program
        self.colmap = colmap
        self.scene = scene
        self.depth_tolerances = depth_tolerances
        self.cloud_tolerances = cloud_tolerances
        self.colmap_environment = colmap_environment(colmap_lib)
        self.has_depth = (scene / "ground_truth" / "depth").is_dir()
        self.scans = scene / "scans" / "scan_alignment.mlp"
        self.has_scans = self.scans.is_file()
        if not self.has_depth and not self.has_scans:
            raise CommandFailed(f"{scene}: no ground_truth/depth and no "
                                "scans/scan_alignment.mlp")

    def score(self, workspace, cloud_path, map_type="geometric"):
        """Scores of the workspace's maps of a type; fuses to cloud_path, or not
        at all if that is None."""
        scores = {}
        if self.has_depth:
            output = run([self.program, "tsar_evaluate", "depth",
                          "--workspace_path", workspace,
                          "--input_type", map_type, "--ground_truth_path",
                          self.scene / "ground_truth" / "depth",
                          "--tolerances", comma_list(self.depth_tolerances),
                          "--json", "1"])
            for row in json.loads(output)["scores"]:
                key = f"depth_{row['area']}_{row['tolerance']:g}"
                scores[key] = [row["precision"], row["recall"], row["f1"]]
        if self.has_scans and cloud_path is not None:
            # With several threads the cloud depends on which comes first, and
            # F1 varies by some thousandths from run to run.
            run([self.colmap, "stereo_fusion", "--workspace_path", workspace,
                 "--input_type", map_type, "--output_path", cloud_path,
                 "--StereoFusion.num_threads", "1"], self.colmap_environment)
            scores.update(self.score_cloud(cloud_path))
        return scores

    def score_tsar_fuse(self, workspace, cloud_path, map_type, device):
        """Scores of the cloud that tsar_fuse makes of the workspace's maps."""
        if not self.has_scans:
            return {}
        run([self.program, "tsar_fuse", "--workspace_path", workspace,
             "--input_type", map_type, "--output_path", cloud_path,
             "--overwrite", "1", "--TsarFuse.device", device])
        return {f"tsar_fuse_{key}": value
                for key, value in self.score_cloud(cloud_path).items()}

    def score_cloud(self, cloud_path):
        """Number of points, and completeness, accuracy and F1 by tolerance."""
        cloud = json.loads(run([
            self.program, "tsar_evaluate", "cloud", "--input_path", cloud_path,
            "--ground_truth_path", self.scans, "--tolerances",
            comma_list(self.cloud_tolerances), "--json", "1"]))
        return {"points": cloud["num_points"],
                **{f"cloud_{row['tolerance']:g}":
                   [row["completeness"], row["accuracy"], row["f1"]]
                   for row in cloud["scores"]}}
