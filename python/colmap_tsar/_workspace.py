# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""A dense workspace, and all that can be done with it."""
import os
import pathlib
import typing
from typing import Any, Callable, Iterator, Optional, Tuple, Union

from . import _core
from ._command_options import FUSE, IMPORT, REFINE, REPORT, STEREO, advice
from ._export import DEPTH_SCALE, export
from ._images import WorkspaceImage
from ._planes import Planes, read_planes
from ._priors import Priors
from ._progress import tell_steps
from ._refine import refine_with_listeners, restore
from ._summaries import (
    ExportSummary,
    FuseSummary,
    ImportSummary,
    RefineSummary,
    ReportSummary,
    RestoreSummary,
    StereoSummary,
)

if typing.TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._keywords import (
        FuseKeywords,
        ImportKeywords,
        RefineKeywords,
        ReportKeywords,
        StereoKeywords,
    )

_Path = Union[str, "os.PathLike[str]"]
_Progress = Union[bool, Callable[[str, int, int], Any]]


class Workspace(typing.Mapping[str, WorkspaceImage]):
    """A dense workspace, as COLMAP's image_undistorter makes it: images/, sparse/ and
    stereo/. A mapping from the names of its images to WorkspaceImage:

        ws = colmap_tsar.Workspace("dense")
        ws.refine()
        for image in ws.images:
            print(image.name, image.depth.shape)
        ws["a.jpg"].confidence

    The sparse model is read once, by the constructor; maps when they are asked for.

    The methods take the options of the commands of the same names as keywords. Their
    keyword `progress` is True: a line for each image, or now and then, on sys.stderr;
    False: none; or a function of (name, done, total): of a pass over the images, how
    many of them are done, and how many it has. It is called from the thread that called
    the method, at the start of each pass and for each image. What it raises ends the
    work in order, as Ctrl-C does, and is raised."""

    # Two objects of one folder may hold different maps.
    __eq__ = object.__eq__
    __ne__ = object.__ne__
    __hash__ = object.__hash__

    def __init__(self, workspace_path: _Path, *, input_type: Optional[str] = None):
        """workspace_path: the folder. input_type: which maps to read, refine and report
        about, "geometric" or "photometric". None: geometric, or photometric where
        there are no geometric ones. Raises Error where it is no workspace."""
        if input_type is not None:
            _core.check_input_type(input_type)
        self._path = pathlib.Path(os.fsdecode(workspace_path))
        self._chosen_type = input_type
        self._facts = _core.read_images(self._path)
        self._planes: Optional[Planes] = None

    def __repr__(self) -> str:
        return f"<Workspace {str(self._path)!r}, {len(self)} images>"

    def __len__(self) -> int:
        return len(self._facts)

    def __iter__(self) -> Iterator[str]:
        return iter(self._facts)

    def __contains__(self, name: object) -> bool:
        return name in self._facts

    def __getitem__(self, name: str) -> WorkspaceImage:
        if name not in self._facts:
            raise KeyError(self._unknown(name))
        return WorkspaceImage(self._path, name, self.input_type, self._facts[name])

    @property
    def path(self) -> pathlib.Path:
        """The folder."""
        return self._path

    @property
    def input_type(self) -> str:
        """The maps that images have here: what the constructor was given, or
        "geometric" where there are such depth maps now, otherwise "photometric"."""
        if self._chosen_type is not None:
            return self._chosen_type
        has_geometric = any(
            _core.has_depth_map(self._path, name, "geometric") for name in self._facts
        )
        return "geometric" if has_geometric else "photometric"

    @property
    def images(self) -> Tuple[WorkspaceImage, ...]:
        """The images, in the order of the sparse model."""
        input_type = self.input_type
        return tuple(
            WorkspaceImage(self._path, name, input_type, facts)
            for name, facts in self._facts.items()
        )

    @property
    def planes(self) -> Planes:
        """The planes of the refined scene, see read_planes(). Read at first use, which
        takes a while, and again after the workspace was changed by this object."""
        if self._planes is None:
            self._planes = read_planes(self._path, input_type=self._chosen_type)
        return self._planes

    def refine(
        self,
        *,
        priors: Optional[Priors] = None,
        progress: _Progress = True,
        **options: "Unpack[RefineKeywords]",
    ) -> RefineSummary:
        """Completes the maps; see the function refine().

            ws.refine(preset="paper", device="cpu")
            ws.refine(num_iterations=3)
            ws.refine(priors={"a.jpg": depth}, prior_type="inverse")
        """
        self._planes = None
        return refine_with_listeners(
            self._path, self._chosen_type, priors, tell_steps(progress), options
        )

    def stereo(
        self, *, progress: _Progress = True, **options: "Unpack[StereoKeywords]"
    ) -> StereoSummary:
        """Makes depth and normal maps from the images, as patch_match_stereo does, on
        NVIDIA GPUs and also without any: what the command tsar_stereo does. Images that
        were done before with the same options are skipped."""
        self._planes = None
        return StereoSummary(
            **_core.stereo(self._to_command(STEREO, options), tell_steps(progress))
        )

    def fuse(
        self,
        output_path: _Path,
        *,
        progress: _Progress = True,
        **options: "Unpack[FuseKeywords]",
    ) -> FuseSummary:
        """Fuses the maps into one point cloud, as stereo_fusion does, on NVIDIA GPUs and
        also without any: what the command tsar_fuse does."""
        given = {"output_path": output_path, **options}
        command = {**self._to_command(FUSE, given), **self._to_type()}
        return FuseSummary(**_core.fuse(command, tell_steps(progress)))

    def import_maps(
        self,
        input_path: _Path,
        format: str,
        output_path: _Path,
        *,
        progress: _Progress = True,
        **options: "Unpack[ImportKeywords]",
    ) -> ImportSummary:
        """Makes a workspace of these photos and this sparse model with the depth and
        normal maps of another program or sensor: what the command tsar_import does."""
        given = {
            **{"input_path": input_path, "format": format, "output_path": output_path},
            **options,
        }
        return ImportSummary(
            **_core.import_maps(self._to_command(IMPORT, given), tell_steps(progress))
        )

    def report(
        self, *, progress: _Progress = True, **options: "Unpack[ReportKeywords]"
    ) -> ReportSummary:
        """Writes a page about the refined workspace, to be opened in a browser: what the
        command tsar_report does."""
        command = {**self._to_command(REPORT, options), **self._to_type()}
        return ReportSummary(**_core.report(command, tell_steps(progress)))

    def export(
        self,
        output_path: _Path,
        format: str,
        *,
        mask_path: Optional[_Path] = None,
        cloud_path: Optional[_Path] = None,
        depth_scale: float = DEPTH_SCALE,
        overwrite: bool = False,
        progress: _Progress = True,
    ) -> ExportSummary:
        """Writes the maps into a folder of their own, with cameras and poses, for other
        programs and for training: what `python -m colmap_tsar export` does.

        format: npy, exr or png16 for maps alone; nerfstudio or 3dgs for a folder to train
        on. All but npy need OpenCV (pip install opencv-python-headless). mask_path: no
        depth where a mask is black; nerfstudio gets the masks as well. cloud_path, for
        nerfstudio: a cloud (PLY) that its methods start from. depth_scale, for png16: units
        of the sparse model per step of depth. overwrite: replace an earlier export; a
        folder with anything else in it is never touched."""
        return export(
            *(self, output_path, format, self._chosen_type, mask_path),
            *(cloud_path, depth_scale, overwrite, progress),
        )

    def restore(self) -> RestoreSummary:
        """Puts COLMAP's maps back; see restore()."""
        self._planes = None
        return restore(self._path)

    def _to_command(self, command, options):
        return {"workspace_path": os.fsencode(self._path), **command.to_text(options)}

    def _to_type(self):
        return {} if self._chosen_type is None else {"input_type": self._chosen_type}

    def _unknown(self, name):
        return f"{self._path} has no image {name!r}{advice(name, self._facts)}"


REFINE.document(Workspace.refine)
STEREO.document(Workspace.stereo)
FUSE.document(Workspace.fuse)
IMPORT.document(Workspace.import_maps)
REPORT.document(Workspace.report)
