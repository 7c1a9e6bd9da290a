# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Maps of a workspace in the formats of other programs, as docs/export.md describes."""
import concurrent.futures
import fcntl
import importlib
import io
import json
import os
import pathlib
import re
import shutil
import sys
from typing import Tuple

from . import _core
from ._errors import Error, make_error
from ._images import WorkspaceImage
from ._numpy import import_numpy
from ._summaries import ExportSummary

FORMATS = ("npy", "exr", "png16", "nerfstudio", "3dgs")
DEPTH_SCALE = 0.001
_MANIFEST, _LIST, _MARKER = "manifest.json", "files.txt", "unfinished_export"
_MAX_LEVEL = 65535
_CONVENTIONS = {
    "units": "lengths are in units of the sparse model",
    "camera_frame": "x right, y down, z forward",
    "poses": "4 x 4, row by row: world_to_camera takes points of the sparse model to the "
    "camera's frame",
    "pixels": "column x and row y count from 0; depth z there is the point z * ((x - cx) / fx, "
    "(y - cy) / fy, 1) of the camera's frame, as for stereo_fusion",
    "half_pixel": "cx and cy are the sparse model's, scaled: in it (0.5, 0.5) is the center of "
    "the top left pixel; what is projected for the photos, as by trainers, takes x + 0.5 and "
    "y + 0.5",
    "values": "scale * stored + offset",
}
_DEPTH = "z in the camera's frame, in units of the sparse model; 0: no depth"
_NORMAL = "unit vector in the camera's frame, towards the camera; (0, 0, 0)"
_PROVENANCES = (
    *("none", "measured", "superpixel plane", "interpolated", "region plane"),
    *("other views", "guessed", "prior"),
)


def _error(code, path, what, advice):
    return make_error(code, f"{path}: {what}; {advice}")


def _files_below(folder):
    """The paths of all that is no folder, links too, relative to the folder."""
    for parent, folders, names in os.walk(folder):
        links = [name for name in folders if os.path.islink(os.path.join(parent, name))]
        for name in names + links:
            yield os.path.relpath(os.path.join(parent, name), folder)


def _is_export(folder):
    try:
        return json.loads((folder / _MANIFEST).read_bytes())["format"] == "tsar_export"
    except (OSError, ValueError, LookupError, TypeError):
        return False


def _foreign_file(folder):
    """A file of an export's folder that the export did not write, or None."""
    try:
        listed = set(os.fsdecode((folder / _LIST).read_bytes()).splitlines())
    except FileNotFoundError:
        listed = set()
    return min(set(_files_below(folder)) - listed, default=None)


def _is_remains(folder):
    """Whether it is of an export that was killed, or a whole one and nothing else."""
    if folder.is_symlink() or not folder.is_dir():
        return False
    names = os.listdir(folder)
    return not names or _MARKER in names or (_is_export(folder) and not _foreign_file(folder))


class _OutputFolder:
    """The folder that an export writes: under another name until it is complete."""

    def __init__(self, path, overwrite):
        self._path = pathlib.Path(os.path.abspath(path))
        self._overwrite, self._is_committed = overwrite, False
        self._temporary = self._path.with_name(self._path.name + ".tsar_tmp")
        self._former = self._path.with_name(self._path.name + ".tsar_old")
        self._check_place()
        if os.path.lexists(self._temporary) and not _is_remains(self._temporary):
            what = "is no unfinished export, and its name is needed for one"
            advice = "give another output_path, or move it away"
            raise _error("unsupported", self._temporary, what, advice)
        self._temporary.mkdir(parents=True, exist_ok=True)
        # The system takes the lock back however the program ends.
        self._lock = os.open(self._temporary, os.O_RDONLY)
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            # Not where it was removed or renamed as complete before it was locked.
            if not os.path.samestat(os.fstat(self._lock), os.lstat(self._temporary)):
                raise BlockingIOError
        except (BlockingIOError, FileNotFoundError):
            os.close(self._lock)
            advice = "wait until it has ended, or give another output_path"
            what = "another export is at work there"
            raise _error("unsupported", self._temporary, what, advice) from None
        (self._temporary / _MARKER).touch()
        for name in set(_files_below(self._temporary)) - {_MARKER}:
            os.remove(self._temporary / name)

    def _check_place(self):
        path, other = self._path, "give another folder as output_path"
        if path.is_symlink():
            raise _error("unsupported", path, "is a link", other)
        if not path.exists() or (path.is_dir() and not os.listdir(path)):
            return
        if not _is_export(path):
            raise _error("unsupported", path, "is there already and is no export", other)
        if not self._overwrite:
            advice = f"give overwrite 1 to replace it, or {other}"
            raise _error("unsupported", path, "holds an export already", advice)
        foreign = _foreign_file(path)
        if foreign is not None:
            what, advice = "is not of the export in this folder", f"move it away, or {other}"
            raise _error("unsupported", path / foreign, what, advice)

    def write(self, name, content):
        path = self._temporary / name
        path.parent.mkdir(parents=True, exist_ok=True)
        with open(path, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())

    def write_json(self, name, value):
        text = json.dumps(value, indent=2, ensure_ascii=False) + "\n"
        self.write(name, text.encode("utf-8", "replace"))

    def commit(self):
        names = sorted(set(_files_below(self._temporary)) - {_MARKER})
        self.write(_LIST, os.fsencode("".join(f"{name}\n" for name in [*names, _LIST])))
        self._check_place()  # Files may have been added meanwhile.
        os.remove(self._temporary / _MARKER)
        if self._path.exists():
            if _is_remains(self._former):
                shutil.rmtree(self._former)
            os.rename(self._path, self._former)
        os.rename(self._temporary, self._path)
        self._is_committed = True
        if _is_remains(self._former):
            shutil.rmtree(self._former)

    def close(self):
        """Leaves nothing of an export that was not committed."""
        if not self._is_committed:
            shutil.rmtree(self._temporary, ignore_errors=True)
        os.close(self._lock)


def _map(meaning, stored, scale=1.0, offset=0.0):
    return {"meaning": meaning, "stored": stored, "scale": scale, "offset": offset}


class _Exporter:
    """An export of a Workspace. Derived classes write one format or several."""

    holds_all_images = False

    def __init__(self, workspace, options):
        self.np = import_numpy()
        self.workspace, self.options, self.format = workspace, options, options["format"]
        self.source = _core.ExportSource(
            workspace.path, options["input_type"], options["mask_path"], options["output_path"]
        )
        self.names = list(workspace)
        self.with_maps = self.source.images_with_maps()

    def import_cv2(self):
        os.environ.setdefault("OPENCV_IO_ENABLE_OPENEXR", "1")
        try:
            return importlib.import_module("cv2")
        except ImportError as error:
            raise ImportError(
                f"the format {self.format} needs OpenCV, which is not there; install it (pip "
                "install opencv-python-headless), or give the format npy"
            ) from error

    def run(self):
        """Writes all; returns the summary."""
        self.folder = _OutputFolder(self.options["output_path"], self.options["overwrite"])
        try:
            self.prepare()
            images = range(len(self.names)) if self.holds_all_images else self.with_maps
            records = self.each(self.export_image, images, "Export:")
            self.finish(records)
            names = {record["name"] for record in records}
            manifest = {
                "format": "tsar_export",
                "version": 1,
                "program": f"colmap_tsar {_core.__version__}",
                "export_format": self.format,
                "map_type": self.source.input_type,
                "conventions": _CONVENTIONS,
                "maps": self.describe(),
                "images": records,
                "images_left_out": [name for name in self.names if name not in names],
            }
            self.folder.write_json(_MANIFEST, manifest)
            self.folder.commit()
        finally:
            self.folder.close()
        sizes = [record["camera"]["width"] * record["camera"]["height"] for record in records]
        depths = [record["num_depths"] for record in records]
        return ExportSummary(
            output_path=pathlib.Path(self.options["output_path"]),
            num_images=len(records),
            num_with_depth=sum(count > 0 for count in depths),
            num_masks=self.source.count_masks(list(images)),
            num_pixels=sum(sizes),
            num_depths=sum(depths),
        )

    def each(self, function, images, name):
        """The results of the function for all images, by several threads."""
        progress, results = self.options["progress"], []
        if callable(progress):
            progress(name.rstrip(":"), 0, len(images))
        pool = concurrent.futures.ThreadPoolExecutor(min(4, os.cpu_count() or 1))
        try:
            for result in pool.map(function, images):
                results.append(result)
                if callable(progress):
                    progress(name.rstrip(":"), len(results), len(images))
                elif progress:
                    print(f"{name} [{len(results)}/{len(images)}]", file=sys.stderr)
        finally:
            pool.shutdown(cancel_futures=True)
        return results

    def view(self, image):
        name = self.names[image]
        return WorkspaceImage(
            self.workspace.path, name, self.source.input_type, self.workspace._facts[name]
        )

    def read_maps(self, image, kinds):
        """{kind: array}; those that the image has. Zeros where it has none at all."""
        np, camera = self.np, self.view(image).camera
        if image not in self.with_maps:
            shape = camera.height, camera.width
            return {"depth": np.zeros(shape, "f4"), "normals": np.zeros((*shape, 3), "f4")}
        maps = {}
        for kind, (width, height, pixels) in self.source.read(image, kinds).items():
            dtype = {"provenance": "u1", "confidence": "u1", "planes": "u2"}.get(kind, "f4")
            maps[kind] = np.frombuffer(pixels, dtype).reshape(
                (height, width, 3) if kind == "normals" else (height, width)
            )
        return maps

    def export_image(self, image):
        np, view = self.np, self.view(image)
        maps = self.read_maps(image, self.kinds)
        world_to_camera = np.vstack([view.cam_from_world, [0, 0, 0, 1]])
        camera_to_world = np.eye(4)
        camera_to_world[:3, :3] = world_to_camera[:3, :3].T
        camera_to_world[:3, 3] = -camera_to_world[:3, :3] @ world_to_camera[:3, 3]
        record = {
            "name": view.name,
            "camera": {"model": "PINHOLE", **vars(view.camera)},
            "world_to_camera": world_to_camera.tolist(),
            "camera_to_world": camera_to_world.tolist(),
            "refined": self.source.is_refined(image),
            "num_depths": int(np.count_nonzero(maps["depth"])),
            "num_out_of_range": 0,
            "files": {},
        }
        self.export(image, maps, record)
        return record

    def levels(self, values):
        """Rounded, halves up."""
        return self.np.floor(values + 0.5).astype("u2")

    def array(self, values, name):
        file = io.BytesIO()
        self.np.save(file, values)
        self.folder.write(name, file.getbuffer())
        return name

    def picture(self, values, name):
        """Three channels: red, green, blue or x, y, z; OpenCV takes the last first."""
        cv2 = self.import_cv2()
        pixels = self.np.ascontiguousarray(values[..., ::-1] if values.ndim == 3 else values)
        try:
            is_written, content = cv2.imencode(name[name.rindex(".") :], pixels)
        except cv2.error:
            is_written = False
        if not is_written:
            what, advice = "this OpenCV cannot write such a picture", "give the format npy"
            raise _error("unsupported", name, what, advice)
        self.folder.write(name, content.tobytes())
        return name

    def photo(self, image):
        path = self.view(image).path
        name = f"images/{self.names[image]}"
        self.folder.write(name, path.read_bytes())
        return name

    def warn(self, records, text):
        """text: of the share of depths that the format does not hold."""
        num_depths = sum(record["num_depths"] for record in records)
        num_out = sum(record["num_out_of_range"] for record in records)
        if num_out > num_depths // 1000:  # A few are no cause for a warning.
            print(f"{100 * num_out / num_depths:.3g} % of the depths {text}", file=sys.stderr)

    def prepare(self):
        """Before the first image."""

    def finish(self, records):
        """After the last one."""


class _Maps(_Exporter):
    """npy, exr and png16: a folder for each kind of map."""

    kinds = ("depth", "normals", "confidence", "sigma", "provenance", "planes")

    def prepare(self):
        self.is_png, self.step = self.format == "png16", self.options["depth_scale"]
        if self.format != "npy":
            self.import_cv2()

    def describe(self):
        def levels(meaning, stored, scale, offset=0.0):
            return _map(meaning, *((stored, scale, offset) if self.is_png else ("float32",)))

        provenance = _map("where the depth comes from", "uint8")
        return {
            "depth": levels(_DEPTH, "uint16", self.step),
            "normals": levels(f"{_NORMAL}: none", "uint16, red green blue", 1 / 32767, -1.0),
            "confidence": levels(
                "probability that the depth is right, to 1 %; 0: no depth", "uint8", 1 / 255
            ),
            "sigma": levels(
                "standard deviation of the depth, in units of the sparse model; 0: no depth",
                *("uint16", 0.01 * self.step),
            ),
            "provenance": {**provenance, "values": _PROVENANCES},
            "planes": _map("1 + the id of the plane that tsar_planes writes; 0: none", "uint16"),
        }

    def to_stored(self, kind, values, record):
        np = self.np
        if kind in ("provenance", "planes"):
            return values
        if kind == "confidence":
            return values if self.is_png else values.astype("f4") / 255
        if not self.is_png:
            return values
        if kind == "normals":
            return self.levels((np.clip(values, -1, 1).astype("f8") + 1) * 32767)
        if kind == "sigma":
            steps = np.clip(values.astype("f8") / (0.01 * self.step), 1, _MAX_LEVEL)
            return self.levels(np.where(values > 0, steps, 0))
        steps = values.astype("f8") / self.step
        fits = (steps >= 0.5) & (steps < _MAX_LEVEL + 0.5)
        record["num_out_of_range"] = int(np.count_nonzero((values > 0) & ~fits))
        return self.levels(np.where(fits, steps, 0))

    def export(self, image, maps, record):
        for kind, values in maps.items():
            stored, path = self.to_stored(kind, values, record), f"{kind}/{self.names[image]}"
            if self.format == "npy":
                record["files"][kind] = self.array(stored, path + ".npy")
            else:
                extension = ".exr" if stored.dtype == "f4" else ".png"
                record["files"][kind] = self.picture(stored, path + extension)

    def finish(self, records):
        self.warn(
            records,
            f"are not between {self.step:g} and {self.step * _MAX_LEVEL:g}, which 16 bits hold at "
            f"depth_scale {self.step:g}, and were left out",
        )


class _Trainer(_Exporter):
    """Training folders, which hold all images and name them in JSON."""

    holds_all_images = True
    kinds: Tuple[str, ...] = ("depth", "normals")

    def prepare(self):
        self.import_cv2()
        for name in self.names:
            try:
                name.encode("utf-8")
            except UnicodeEncodeError:
                raise self.refused(f"the name of the image {name} is not UTF-8") from None

    def refused(self, what):
        advice = "rename images and make the workspace again, or give another format"
        return _error("unsupported", self.workspace.path / "sparse", what, advice)


class _Nerfstudio(_Trainer):
    """Depth as arrays in thousandths of a unit, which nerfstudio takes for millimeters."""

    def prepare(self):
        super().prepare()
        self.cloud, path = None, self.options["cloud_path"]
        if path is not None:
            self.cloud = pathlib.Path(path).read_bytes()
            header = re.match(rb"ply\s.*?\nelement vertex (\d+)\s", self.cloud[:10000], re.DOTALL)
            if header is None or int(header[1]) == 0:
                advice = "give the cloud of tsar_fuse or stereo_fusion"
                raise _error("not_found", path, "is no PLY file with points", advice)

    def describe(self):
        none = f"{_NORMAL}, which is stored as 128, 128, 128: none"
        maps = {
            "depth": _map(_DEPTH, "float32", 0.001),
            "normals": _map(none, "uint8, red green blue", 1 / 127.5, -1.0),
        }
        if self.options["mask_path"] is not None:
            maps["mask"] = {"meaning": "0: masked, 255: not", "stored": "uint8"}
        return maps

    def export(self, image, maps, record):
        np, files, name = self.np, record["files"], self.names[image]
        camera, (height, width) = self.view(image).photo_camera, maps["depth"].shape
        files["photo"] = self.photo(image)
        files["depth"] = self.array(maps["depth"] * np.float32(1000), f"depths/{name}.npy")
        rows = (2 * np.arange(camera.height) + 1) * height // (2 * camera.height)
        columns = (2 * np.arange(camera.width) + 1) * width // (2 * camera.width)
        normals = np.clip(maps["normals"], -1, 1)[rows][:, columns]
        colors = self.levels(np.float32(127.5) + np.float32(127.5) * normals).astype("u1")
        files["normals"] = self.picture(colors, f"normals/{name}.png")
        if self.options["mask_path"] is not None:
            of_maps = self.map_camera(image)
            mask = self.source.mask_of_photo(image, of_maps.width, of_maps.height)
            is_masked = np.zeros((camera.height, camera.width), "u1")
            if mask is not None:
                is_masked = np.frombuffer(mask[2], "u1").reshape(is_masked.shape)
            files["mask"] = self.picture(255 * (1 - is_masked), f"masks/{name}.png")

    def map_camera(self, image):
        """That of the image's maps or, without any, of another's whose photo is as large."""
        own = self.view(image).photo_camera
        for other in [image] if image in self.with_maps else self.with_maps:
            view = self.view(other)
            if (view.photo_camera.width, view.photo_camera.height) == (own.width, own.height):
                return view.camera
        return own

    def finish(self, records):
        np = self.np
        transforms = {"camera_model": "OPENCV", "applied_transform": np.eye(3, 4).tolist()}
        if self.cloud is not None:
            self.folder.write("points.ply", self.cloud)
            transforms["ply_file_path"] = "points.ply"
        transforms["frames"] = frames = []
        for image, record in enumerate(records):
            files, camera = record["files"], self.view(image).photo_camera
            frame = {
                "file_path": files["photo"],
                "depth_file_path": files["depth"],
                "normal_file_path": files["normals"],
                **({"mask_path": files["mask"]} if "mask" in files else {}),
                **{"w": camera.width, "h": camera.height, "fl_x": camera.fx, "fl_y": camera.fy},
                **{"cx": camera.cx, "cy": camera.cy},
            }
            # OpenGL's camera: x right, y up, z backward.
            pose = np.array(record["camera_to_world"]) * [1, -1, -1, 1]
            frames.append({**frame, "transform_matrix": pose.tolist()})
        self.folder.write_json("transforms.json", transforms)


class _GaussianSplatting(_Trainer):
    """Inverse depth = level / 65536 * scale, with one scale for all images: the trainer drops
    those whose scale differs from the median by more than a factor of five."""

    kinds = ("depth",)

    def prepare(self):
        super().prepare()
        self.stems = [name.rpartition(".")[0] for name in self.names]
        name_of = {}
        for name, stem in zip(self.names, self.stems):
            if not stem:
                raise self.refused(f"the name of the image {name} has no extension, which the format needs")
            if stem in name_of:
                raise self.refused(
                    f"the images {name_of[stem]} and {name} differ in their extensions alone, "
                    "so that the format would have one depth map for both"
                )
            name_of[stem] = name
        found = self.each(self.nearest_and_median, self.with_maps, "Export, pass 1 of 2:")
        found = [one for one in found if one is not None]
        if not found:
            what = f"no pixel of its {self.source.input_type} maps has a depth"
            advice = "run patch_match_stereo on it again"
            raise _error("not_found", self.workspace.path, what, advice)
        nearest = min(nearest for nearest, _ in found)
        # Single near pixels must not coarsen the levels of all others.
        nearest = max(nearest, self.median(self.np.array([median for _, median in found])) / 16)
        self.scale = 65536 / _MAX_LEVEL / nearest

    def median(self, values):
        middle = (len(values) - 1) // 2
        return float(self.np.partition(values, middle)[middle])

    def nearest_and_median(self, image):
        depth = self.read_maps(image, ("depth",))["depth"]
        depth = depth[depth > 0]
        return (float(depth.min()), self.median(depth)) if len(depth) else None

    def describe(self):
        inverse = "1 / z in the camera's frame, z in units of the sparse model; 0: no depth"
        return {
            "inverse_depth": _map(inverse, "uint16", self.scale / 65536),
            "depth_mask": {"meaning": "255: depth, 0: no depth", "stored": "uint8"},
        }

    def export(self, image, maps, record):
        np, stem, has_depth = self.np, self.stems[image], maps["depth"] > 0
        levels = 65536 / (self.scale * np.where(has_depth, maps["depth"], 1).astype("f8"))
        is_too_near = has_depth & (levels >= _MAX_LEVEL + 0.5)
        record["num_out_of_range"] = int(np.count_nonzero(is_too_near))
        levels = self.levels(np.where(has_depth, np.clip(levels, 1, _MAX_LEVEL), 0))
        mask = np.where(has_depth, 255, 0).astype("u1")
        record["files"] = {
            "photo": self.photo(image),
            "inverse_depth": self.picture(levels, f"depths/{stem}.png"),
            "depth_mask": self.picture(mask, f"depth_masks/{stem}.png"),
        }

    def finish(self, records):
        for path in self.source.sparse_model_files():
            self.folder.write(f"sparse/0/{path.name}", path.read_bytes())
        params = {
            stem: {"scale": self.scale if record["num_depths"] else 0.0, "offset": 0.0}
            for stem, record in zip(self.stems, records)
        }
        self.folder.write_json("sparse/0/depth_params.json", params)
        self.warn(records, f"are nearer than {1 / self.scale:g} and were stored as that")


def export(
    workspace, output_path, format, input_type, mask_path, cloud_path, depth_scale, overwrite, progress
):
    """What Workspace.export() does."""
    options = {key: value for key, value in locals().items() if key != "workspace"}
    if format not in FORMATS:
        raise make_error("bad_option", f"format: '{format}' is not known; give {', '.join(FORMATS)}")
    if depth_scale != DEPTH_SCALE and format != "png16":
        raise make_error("bad_option", "depth_scale is for the format png16 alone; leave it out")
    if not 1e-12 <= depth_scale <= 1e12:
        raise make_error("bad_option", f"depth_scale: {depth_scale} is not between 1e-12 and 1e12")
    if cloud_path is not None and format != "nerfstudio":
        raise make_error("bad_option", "cloud_path is for the format nerfstudio alone; leave it out")
    exporters = {"nerfstudio": _Nerfstudio, "3dgs": _GaussianSplatting}
    try:
        return exporters.get(format, _Maps)(workspace, options).run()
    except OSError as error:
        if error.filename is None or isinstance(error, Error):
            raise
        code = "not_found" if isinstance(error, FileNotFoundError) else "io"
        advice = "make room, or check the path and its permissions"
        raise _error(code, error.filename, error.strerror, advice) from error
