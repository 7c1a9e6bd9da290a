# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""What runs did."""
import dataclasses
import pathlib
from typing import Dict, List, Optional

from ._result import PrintedResult, Result


@dataclasses.dataclass(frozen=True)
class RefineSummary(PrintedResult):
    """What a run of refine() did. str() of it is the account that the command
    prints."""

    workspace_path: pathlib.Path
    """The workspace that was written: output_path where that was given."""
    input_type: str
    """The maps that were refined: such as "geometric"."""
    device: str
    """Where it was computed, in words."""
    num_workers: int
    """Images at a time."""
    num_images: int
    """All images of stereo/patch-match.cfg."""
    num_observed: int
    """Images that were observed now, by a pass that does nothing else."""
    num_refined: int
    """Images that were refined now."""
    num_skipped: int
    """Images that had been refined before with the same options."""
    num_masks: Optional[int]
    """Of num_images, those with a mask; None where no masks were given."""
    num_priors: Optional[int]
    """The same of depth priors."""
    kept: Dict[str, str]
    """Images that keep COLMAP's maps: name and reason."""
    num_sources_without_maps: int
    """Source images, over all images, that were left out for want of maps."""
    counts: Dict[str, int]
    """Sums over the refined images, those of former runs too, in pixels: "pixels",
    "depth_before", "depth_after", "not_finite", and how many have each provenance."""
    seconds: Dict[str, float]
    """Time of each stage, summed over the refined images."""
    wall_seconds: float
    """Time from start to end."""
    peak_gpu_memory: Dict[str, int]
    """The most bytes held at a time on each GPU."""
    text: str = dataclasses.field(repr=False)


@dataclasses.dataclass(frozen=True)
class RestoreSummary(Result):
    """What restore() did."""

    num_restored: int
    """Maps of how many images and types were put back."""
    kept: List[str]
    """Maps that were written since in the place of refined ones, and stay."""
    superseded: List[str]
    """Where what had to make room is now."""
    lost: List[str]
    """Refined depth maps whose originals are gone: left as they were."""


@dataclasses.dataclass(frozen=True)
class StereoSummary(PrintedResult):
    """What Workspace.stereo() did. str() of it is the account that the command
    prints."""

    workspace_path: pathlib.Path
    input_type: str
    """The maps for the next step: "geometric", or "photometric" where only those were
    made."""
    device: str
    """Where it was computed, in words."""
    num_images: int
    """All images of stereo/patch-match.cfg."""
    num_skipped: int
    """Images that had been done before."""
    num_masks: Optional[int]
    """Of num_images, those with a mask; None where no masks were given."""
    without_sources: List[str]
    """Images without maps, since no other shares enough sparse points with them."""
    wall_seconds: float
    peak_gpu_memory: Dict[str, int]
    """The most bytes held at a time on each GPU."""
    text: str = dataclasses.field(repr=False)


@dataclasses.dataclass(frozen=True)
class FuseSummary(Result):
    """What Workspace.fuse() wrote."""

    output_path: pathlib.Path
    """The cloud; beside it, with .vis behind its name, the images that see each
    point."""
    device: str
    """Where it was computed, in words."""
    num_images: int
    """Images whose pixels could become points."""
    num_masks: Optional[int]
    """Of num_images, those with a mask; None where no masks were given."""
    num_points: int
    wall_seconds: float
    peak_gpu_memory: Dict[str, int]
    """The most bytes held at a time on each GPU."""


@dataclasses.dataclass(frozen=True)
class ImportSummary(PrintedResult):
    """What Workspace.import_maps() did. str() of it is the account that the command
    prints."""

    output_path: pathlib.Path
    """The workspace that was made."""
    output_type: str
    """The maps that were written: such as "geometric"."""
    num_images: int
    """Images of the sparse model."""
    num_imported: int
    num_without_image: int
    """Maps of images that the model does not hold."""
    num_with_normals: int
    """Images whose normals came with them; those of others are made from depth."""
    num_pixels: int
    num_with_depth: int
    """Pixels with depth as the maps came."""
    num_kept: int
    """Those of them that are in the maps that were written."""
    scale: Optional[float]
    """Depth over that of the sparse points, the median over the images, before any
    scaling; None where too few points tell."""
    warnings: List[str]
    """Things to look at, one line each."""
    text: str = dataclasses.field(repr=False)


@dataclasses.dataclass(frozen=True)
class ReportSummary(Result):
    """What Workspace.report() wrote."""

    page_path: pathlib.Path
    """The page, for a browser."""
    num_images: int
    """Images that the page shows."""


@dataclasses.dataclass(frozen=True)
class ExportSummary(Result):
    """What Workspace.export() wrote."""

    output_path: pathlib.Path
    """The folder."""
    num_images: int
    num_with_depth: int
    """Images with any depth."""
    num_masks: Optional[int]
    """Of num_images, those with a mask; None where no masks were given."""
    num_pixels: int
    """Of the maps of all images."""
    num_depths: int
    """Pixels with depth."""
