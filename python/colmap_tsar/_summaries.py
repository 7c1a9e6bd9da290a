# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""What the runs of a Workspace did."""
import dataclasses
import pathlib
from typing import Dict, List, Optional

from ._result import PrintedResult, Result


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
class ImportSummary(PrintedResult):
    """What Workspace.import_maps() did. str() of it is the account that the command
    prints."""

    workspace_path: pathlib.Path
    output_type: str
    """The maps that were written: "geometric" or "photometric"."""
    num_images: int
    """Images of the sparse model."""
    num_imported: int
    num_without_image: int
    """Maps of images that the model does not hold."""
    num_with_normals: int
    """Images whose normals came with them; those of others are made from depth."""
    num_with_costs: int
    num_pixels: int
    num_with_depth: int
    scale: Optional[float]
    """Depth over that of the sparse points, the median over the images, before any
    scaling; None where too few points tell."""
    warnings: List[str]
    """Things to look at, one line each."""
    text: str = dataclasses.field(repr=False)


@dataclasses.dataclass(frozen=True)
class ReportSummary(Result):
    """What Workspace.report() wrote."""

    page_path: Optional[pathlib.Path]
    """The page, for a browser; None where only a picture was asked for."""
    picture_path: Optional[pathlib.Path]
    """The picture, where output_path was given."""
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
