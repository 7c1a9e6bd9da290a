# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""What reconstruct.sh makes of a refined workspace and its cloud on request: meshes
by COLMAP, with texture if wanted, and exports."""
import math
import os
import re
import subprocess
import sys

import ply
from dense import REFINED, mask_options
from files import DatasetError
from programs import REPOSITORY, as_words, files_named_by
from steps import remove

MESHES = ("poisson", "delaunay")
EXPORTS = ("npy", "exr", "png16", "nerfstudio", "3dgs")


def add_product_options(parser):
    parser.add_argument("--mesh", choices=MESHES, nargs="?", const=MESHES[0], action="append",
                        default=[], help="mesh the refined cloud: poisson (the default) closes "
                        "gaps; delaunay keeps to what the cameras saw, and needs a COLMAP with CGAL")
    parser.add_argument("--texture", action="store_true", help="put the photos on each mesh, "
                        "whatever masks say; needs COLMAP 4.0 or later with CGAL")
    parser.add_argument("--export", choices=EXPORTS, action="append", default=[],
                        help="export the refined maps by python -m colmap_tsar export; may be given "
                        "several times")
    parser.add_argument("--python", metavar="PATH", default=sys.executable,
                        help="the Python that has the module colmap_tsar (default: this one)")
    parser.add_argument("--depth_scale", type=float, metavar="UNITS", help="of --export png16: units of the "
                        "model per step of depth (default: 0.001)")


def product_steps(args):
    args.mesh, args.export = (list(dict.fromkeys(kinds)) for kinds in (args.mesh, args.export))
    return ([f"mesh_{kind}" for kind in args.mesh]
            + [f"texture_{kind}" for kind in textured_meshes(args)]
            + [f"export_{form}" for form in args.export])


def product_commands(args):
    return [f"{kind}_mesher" for kind in args.mesh] + ["mesh_texturer"] * args.texture


def textured_meshes(args):
    return args.mesh if args.texture else []


def check_products(args, programs):
    """That they can be made, before hours are spent on the cloud."""
    if args.depth_scale is not None and "png16" not in args.export:
        raise DatasetError("--depth_scale: is for --export png16")
    if args.depth_scale is not None and not 0 < args.depth_scale < math.inf:
        raise DatasetError(f"--depth_scale {args.depth_scale}: is not a number above 0")
    # The module that was built here, where none is installed.
    paths = os.environ.get("PYTHONPATH", ""), str(REPOSITORY / "build" / "python")
    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, paths))
    modules = "colmap_tsar, numpy" + (", cv2" if set(args.export) - {"npy"} else "")
    if args.export and subprocess.run([args.python, "-c", f"import {modules}"],
                                      stderr=subprocess.DEVNULL).returncode != 0:
        raise DatasetError(f"--export: {args.python} cannot import {modules}; install what is "
                           "missing, or name another by --python")
    for kind in args.mesh:
        text = programs.colmap_help(f"{kind}_mesher")
        if f"{kind.capitalize()}Meshing." not in text:
            reason = ("was built without CGAL; use --mesh poisson or name another by --colmap"
                      if "CGAL" in text else "does not have it; name another by --colmap")
            raise DatasetError(f"--mesh {kind}: {programs.colmap} {reason}")
    if args.texture:
        check_texture(args, programs)


def check_texture(args, programs):
    if not args.mesh:
        raise DatasetError("--texture: is for meshes; give --mesh as well")
    if "MeshTextureMapping." not in programs.colmap_help("mesh_texturer"):
        raise DatasetError(f"--texture: {programs.colmap} has no mesh_texturer, which came with "
                           "COLMAP 4.0; leave it out or name another by --colmap")
    # Without CGAL mesh_texturer takes every surface for one that all photos see, and
    # does not say so.
    if "CGAL" in programs.colmap_help("delaunay_mesher"):
        raise DatasetError(f"--texture: {programs.colmap} was built without CGAL and cannot tell "
                           "which surfaces a photo sees; leave it out or name another by --colmap")


def poisson_options(num_points):
    """COLMAP trims what its octree resolves less than 10 times, which leaves nothing of
    a cloud of less than about a million points."""
    return {"PoissonMeshing.trim": max(4, min(10, int(math.log(max(num_points, 1), 4))))}


def make_mesh(scene, args, programs, kind):
    name, command = f"mesh_{kind}", f"{kind}_mesher"
    mesh, cloud = mesh_file(scene, kind), scene.folder / "after.ply"
    options = args.passed.get(command, {})
    if kind == "poisson":
        options = {**poisson_options(ply.count(cloud, "vertex")), **options}

    def action(step):
        part = scene.folder / f"part.{name}.ply"
        remove(part)
        remove(textured(scene, kind))  # It is of the mesh that was there before.
        step.run(programs.colmap, command, "--input_path", cloud if kind == "poisson" else
                 with_cloud(scene), "--output_path", part, *as_words(options))
        if not part.exists():
            raise DatasetError(f"{scene.name}: {name}: COLMAP wrote no mesh; see {step.log}")
        if ply.count(part, "face") == 0:
            hint = "; a smaller --PoissonMeshing.trim leaves more" if kind == "poisson" else ""
            raise DatasetError(f"{scene.name}: {name}: the mesh is empty{hint}; see {step.log}")
        os.replace(part, mesh)

    scene.step(name, action, outputs=[mesh.name], after=["fusion_after"],
               options={**options, "colmap": programs.versions["colmap"]})


def mesh_file(scene, kind):
    return scene.folder / f"mesh_{kind}.ply"


def textured(scene, kind):
    return scene.folder / f"textured_{kind}"


def make_texture(scene, args, programs, kind):
    name, options = f"texture_{kind}", args.passed.get("mesh_texturer", {})
    folder = textured(scene, kind)

    def action(step):
        part = scene.folder / f"part.{name}"
        remove(part)
        step.run(programs.colmap, "mesh_texturer", "--workspace_path", scene.folder / REFINED,
                 "--input_path", mesh_file(scene, kind), "--output_path", part, *as_words(options))
        if not (part / "mesh.ply").exists():
            raise DatasetError(f"{scene.name}: {name}: COLMAP wrote no mesh; see {step.log}")
        os.replace(part, folder)

    scene.step(name, action, outputs=[folder.name], after=[f"mesh_{kind}"],
               options={**options, "colmap": programs.versions["colmap"]})


def with_cloud(scene):
    """The refined workspace with the cloud where delaunay_mesher looks for it."""
    workspace = scene.folder / REFINED
    for ending in (".ply", ".ply.vis"):
        link = workspace / f"fused{ending}"
        remove(link)
        link.symlink_to(f"../after{ending}")
    return workspace


def make_export(scene, args, programs, form, masks):
    name = f"export_{form}"
    options = mask_options(masks)
    if form == "png16" and args.depth_scale is not None:
        options["depth_scale"] = args.depth_scale
    elif form == "nerfstudio":
        options["cloud_path"] = str(scene.folder / "after.ply")

    def action(step):
        # The command replaces its own files alone: a trainer may have written there.
        step.run(args.python, "-m", "colmap_tsar", "export", "--workspace_path", scene.folder / REFINED,
                 "--format", form, "--output_path", scene.folder / name, "--overwrite", 1,
                 *as_words(options))
        # Whether the format holds the depths well depends on the model's scale.
        for line in step.log.read_text(encoding="utf-8", errors="replace").splitlines():
            if not re.match(r"\$ |Export.*: \[", line):
                scene.say(line.strip())

    scene.step(name, action, outputs=[name], removes=False,
               after=["fusion_after" if "cloud_path" in options else "refinement"],
               inputs=files_named_by(options),
               options={**options, "colmap_tsar": programs.versions["colmap_tsar"]})


def make_products(scene, args, programs, masks):
    """Those that are asked for. Others of former runs stay while they are of the
    same cloud, and textures of the same mesh; so do exports, in which a trainer may
    have left its files."""
    for kind in MESHES:
        if kind not in args.mesh:
            scene.retire(f"mesh_{kind}", mesh_file(scene, kind).name)
        if kind not in textured_meshes(args):
            scene.retire(f"texture_{kind}", textured(scene, kind).name)
    for form in EXPORTS:
        scene.retire(f"export_{form}", f"export_{form}")
    for kind in args.mesh:
        make_mesh(scene, args, programs, kind)
    for kind in textured_meshes(args):
        make_texture(scene, args, programs, kind)
    for form in args.export:
        make_export(scene, args, programs, form, masks)
