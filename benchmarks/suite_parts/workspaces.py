# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""Workspaces at other sizes and levels of noise, kept in a cache."""

import hashlib
import json
import shlex
import shutil

from programs import CommandFailed, own_folder, run
from suite_parts import simulated_priors
from suite_parts.photographs import convert_image
from suite_parts.simulated_priors import KINDS, make_priors, name_of
from suite_parts.sparse_model import read_model, write_text

# Raised where a workspace of the cache would be made in another way.
VERSION = 2
INPUTS = ("images", "sparse", "stereo/depth_maps", "stereo/normal_maps",
          "stereo/patch-match.cfg", "stereo/fusion.cfg")
TRUTHS = ("ground_truth", "scans")


def hash_files(root, names):
    """A hash of the contents of files below a workspace and of their names."""
    digest = hashlib.sha256()
    for name in names:
        top = root / name
        for path in [top] if top.is_file() else sorted(top.rglob("*")):
            if path.is_file():
                digest.update(f"{path.relative_to(root)}\n".encode())
                digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()


class Workspaces:
    """Prepares configurations; the scenes themselves are never changed."""

    def __init__(self, cache, program, stereo_options):
        self.cache = cache
        self.program = program
        self.stereo_options = shlex.split(stereo_options)
        self.hashes = {}

    def hash_of(self, root, names):
        key = (root, names)
        if key not in self.hashes:
            self.hashes[key] = hash_files(root, names)
        return self.hashes[key]

    def prepare(self, configuration):
        """The workspace, and a fingerprint of all that its scores depend on."""
        scene = configuration.path
        if configuration.maps == "own":
            workspace = scene
        else:
            workspace = self._made(configuration)
        prints = [self.hash_of(workspace, INPUTS), self.hash_of(scene, TRUTHS)]
        return workspace, hashlib.sha256(
            " ".join(prints).encode()).hexdigest()

    def with_priors(self, configuration, options):
        """The options, with the folders of simulated priors that they name."""
        kinds = {name_of(kind): kind for kind in KINDS}
        return [self._priors(configuration, kinds[word]) if word in kinds
                else word for word in options]

    def _kept(self, name, content, key, make):
        """What make(path) writes at cache/name/content, made again only if the
        key differs from the last one."""
        folder = own_folder(self.cache / name)
        record, path = folder / "made_from.json", folder / content
        if not (record.is_file() and json.loads(record.read_text()) == key):
            shutil.rmtree(path, ignore_errors=True)
            record.unlink(missing_ok=True)
            make(path)
            record.write_text(json.dumps(key))
        return path

    def _priors(self, configuration, kind):
        scene = configuration.path
        key = {"version": simulated_priors.VERSION,
               "scene": self.hash_of(scene, ("images", "ground_truth"))}
        return self._kept(f"{scene.name}-{kind}-prior", "priors", key,
                          lambda folder: make_priors(scene, kind, folder))

    def _made(self, configuration):
        key = {"version": VERSION, "options": self.stereo_options,
               "scene": self.hash_of(configuration.path, INPUTS[:2] + INPUTS[4:])}

        def make(workspace):
            print(f"making {configuration.label()}", flush=True)
            self._write(configuration, workspace)
            run([self.program, "tsar_stereo", "--workspace_path", workspace,
                 *self.stereo_options])

        return self._kept(configuration.stem(), "workspace", key, make)

    def _write(self, configuration, workspace):
        """The scene without maps, at the requested size and noise."""
        scene = configuration.path
        old = read_model(scene / "sparse")
        new = old.scaled(configuration.size)
        write_text(new, workspace / "sparse")
        for image in new.images:
            camera, before = (model.cameras[image.camera_id]
                              for model in (new, old))
            source = scene / "images" / image.name
            target = workspace / "images" / image.name
            if not source.is_file():
                raise CommandFailed(f"{source}: no such image")
            size = (camera.width, camera.height)
            if configuration.noise or size != (before.width, before.height):
                convert_image(source, target, size, configuration.noise)
            else:
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(source, target)
        for name in ("depth_maps", "normal_maps"):
            (workspace / "stereo" / name).mkdir(parents=True)
        for name in ("patch-match.cfg", "fusion.cfg"):
            if (scene / "stereo" / name).is_file():
                shutil.copy(scene / "stereo" / name, workspace / "stereo")
