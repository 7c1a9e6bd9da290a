# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Refining a workspace, and taking it back."""
import dataclasses
import os
import pathlib
from typing import Any, Callable, Dict, List, Mapping, Optional, Union

from . import _core
from ._options import RefineOptions
from ._progress import tell_lines
from ._result import PrintedResult, Result

_Path = Union[str, "os.PathLike[str]"]


@dataclasses.dataclass(frozen=True)
class RefineSummary(PrintedResult):
    """What a run of refine() did. str() of it is the account that the command
    prints."""

    workspace_path: pathlib.Path
    """The workspace that was written: output_path where that was given."""
    input_type: str
    """The maps that were refined: "geometric" or "photometric"."""
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
    kept: Dict[str, str]
    """Images that keep COLMAP's maps: name and reason."""
    num_sources_without_maps: int
    """Source images, over all images, that were left out for want of maps."""
    counts: Dict[str, int]
    """Sums over the refined images, in pixels: "pixels", "depth_before",
    "depth_after", "not_finite", and how many have each provenance."""
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
    """Depth maps that patch_match_stereo has written since, or that were kept on
    demand: left as they were, with their normal maps."""
    superseded: List[str]
    """Where the maps are now that stood in the place of originals and were not
    written by this program as they were."""
    conflicts: List[str]
    """Depth maps for which nothing was changed, since nothing tells whose they
    and their normal maps are."""


def refine(
    workspace_path: _Path,
    options: Union[RefineOptions, Mapping[str, Any], None] = None,
    *,
    output_path: Optional[_Path] = None,
    input_type: Optional[str] = None,
    image_list_path: Optional[_Path] = None,
    mask_path: Optional[_Path] = None,
    device: str = "auto",
    gpu_index: Union[str, int] = "-1",
    num_threads: int = -1,
    cache_size: float = 32.0,
    shard: str = "",
    pass_: str = "all",
    progress: Union[bool, Callable[[str], None]] = True,
) -> RefineSummary:
    """Completes the depth and normal maps of a dense workspace.

    Run it after patch_match_stereo and before stereo_fusion. It does what the
    command `colmap_tsar tsar_refine` does, with the same results: the refined maps
    take the names of COLMAP's, which are kept, so that restore() can put them back.
    Images that were refined before with the same options are skipped.

    Other Python threads go on meanwhile. Ctrl-C (in the main thread, as ever in
    Python) raises KeyboardInterrupt once the images at work have come to an end;
    pressing it again does not change that. The workspace is whole afterwards, and
    the same call goes on where it stopped.

    Args:
        workspace_path: The dense workspace, as image_undistorter makes it and
            patch_match_stereo fills it: images/, sparse/, stereo/.
        options: RefineOptions, or a dict of some; None for the defaults.
        output_path: Write a second workspace here, with links to the images, and
            leave the first as it is. None: refine in place.
        input_type: Which maps to refine, "geometric" or "photometric"; the others
            serve as evidence where they exist. None: geometric, or photometric
            where there are no geometric ones.
        image_list_path: A text file with one image name per line: refine these
            alone. None: all.
        mask_path: The folder with masks of the undistorted images, named as for
            COLMAP: a.jpg.png for a.jpg. Where a mask is black (0), what the maps
            hold is no evidence for anything, and the refined maps have no depth.
            None: no masks.
        device: Where to compute: "auto" (on a GPU where there is one), "cuda" or
            "cpu".
        gpu_index: The GPUs to use, as numbers from 0 on with commas between them,
            such as "0,1"; -1 takes every GPU of the machine.
        num_threads: Number of CPU threads; -1: one for each core.
        cache_size: Main memory for the images at work, in gigabytes (10^9 bytes);
            at most four fifths of the machine's count.
        shard: For several machines with one file system: the part of the images to
            work on, "i/n" with i from 0 to n - 1 (docs/cluster.md). Empty: all.
        pass_: What to do of it: "all", "observe", "model", "compose" or
            "merge".
        progress: True: a line for each image, or now and then, on sys.stderr.
            False: none. A function: called with each such line, from the thread
            that called refine(), for instance logging.getLogger().info. What it
            raises stops the work as Ctrl-C does, and is raised.

    Returns:
        What was done, and how long it took.

    Raises:
        Error: One of its subclasses; see there.
        TypeError: An option does not exist or has a value of a wrong type.
    """
    if options is None:
        options = RefineOptions()
    elif not isinstance(options, RefineOptions):
        options = RefineOptions(**options)
    return refine_with_listeners(
        workspace_path,
        options,
        tell_lines(progress),
        output_path=output_path,
        input_type=input_type,
        image_list_path=image_list_path,
        mask_path=mask_path,
        device=device,
        gpu_index=gpu_index,
        num_threads=num_threads,
        cache_size=cache_size,
        shard=shard,
        pass_=pass_,
    )


def refine_with_listeners(
    workspace_path,
    options,
    listeners,
    *,
    output_path,
    input_type,
    image_list_path,
    mask_path,
    device,
    gpu_index,
    num_threads,
    cache_size,
    shard,
    pass_,
):
    """refine(), with the listeners of _progress.py."""
    return RefineSummary(
        **_core.refine(
            os.fspath(workspace_path),
            options.todict(),
            "" if output_path is None else os.fspath(output_path),
            input_type,
            "" if image_list_path is None else os.fspath(image_list_path),
            "" if mask_path is None else os.fspath(mask_path),
            device,
            str(gpu_index),
            num_threads,
            cache_size,
            shard,
            pass_,
            listeners,
        )
    )


def restore(workspace_path: _Path, conflicts: str = "report") -> RestoreSummary:
    """Puts COLMAP's maps back and removes all that refine() wrote. What others wrote
    in their place since is never removed.

    conflicts: what to do where nothing tells whose the depth and normal maps of an
    image are, such as where one of the two alone was written anew: "report" changes
    nothing for this image, "keep" leaves what is there, "original" puts the
    originals back, also where another program has made both maps anew.

    Raises NotFoundError where there is nothing to restore, and UnsupportedError for
    a workspace that refine() made as output_path: COLMAP's maps are in the other
    one.
    """
    return RestoreSummary(**_core.restore(os.fspath(workspace_path), conflicts))
