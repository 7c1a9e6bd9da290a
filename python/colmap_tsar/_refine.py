# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Refining a workspace, and taking it back."""
import os
import typing
from typing import Callable, Optional, Union

from . import _core
from ._command_options import REFINE
from ._priors import Priors, options_with_priors
from ._progress import tell_lines
from ._summaries import RefineSummary, RestoreSummary

if typing.TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._keywords import RefineKeywords

_Path = Union[str, "os.PathLike[str]"]


def refine(
    workspace_path: _Path,
    *,
    input_type: Optional[str] = None,
    priors: Optional[Priors] = None,
    progress: Union[bool, Callable[[str], None]] = True,
    **options: "Unpack[RefineKeywords]",
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
        input_type: Which maps to refine, "geometric" or "photometric". None:
            geometric, or photometric where there are no geometric ones.
        priors: Depth of single images from a network or a sensor, instead of files
            in `prior_path`: {name of the image: array}, or a function of the name
            that returns the array, or None where there is none. The array has the
            shape (height, width) and whatever size has the photo's shape; 0 is no
            depth. A tuple (depth, normals) adds normals, (height, width, 3), as
            prior_path describes them below; either may be None. What the values
            mean is said by `prior_type`. Without NumPy, arrays must be buffers of
            floats (memoryview). The arrays are written to a temporary folder, and a
            function is called for all images before the work begins. Images are
            skipped if they were refined before with the same arrays.
        progress: True: a line every ten seconds and one at the end, on sys.stderr.
            False: none. A function: called with each such line, from the thread
            that called refine(), for instance logging.getLogger().info. What it
            raises stops the work as Ctrl-C does, and is raised.
        options: Those of the command, below.

    Returns:
        What was done, and how long it took.

    Raises:
        Error: One of its subclasses; see there.
        TypeError: An option does not exist or has a value of a wrong type.
    """
    return refine_with_listeners(
        workspace_path, input_type, priors, tell_lines(progress), options
    )


def refine_with_listeners(workspace_path, input_type, priors, listeners, options):
    """refine(), with the listeners of _progress.py."""
    REFINE.to_text(options)  # Wrong ones are errors before priors are asked for.
    with options_with_priors(workspace_path, priors, options) as given:
        command = {"workspace_path": os.fsencode(workspace_path), **REFINE.to_text(given)}
        if input_type is not None:
            command["input_type"] = input_type
        return RefineSummary(**_core.refine(command, listeners))


def restore(workspace_path: _Path) -> RestoreSummary:
    """Puts COLMAP's maps back and removes all that refine() wrote. What others wrote
    in their place since is never removed.

    Raises NotFoundError where there is nothing to restore.
    """
    return RestoreSummary(**_core.restore(os.fspath(workspace_path)))


REFINE.document(refine)
