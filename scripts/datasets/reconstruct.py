# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""From a folder of photos to a refined cloud; see scripts/reconstruct.sh."""
import os
import pathlib

import dense
import ply
from command_line import add_options, dense_commands, new_parser, run_main
from features import extract_features, match_features
from files import (IMAGE_ENDINGS, DatasetError, check_photo, find_photos, has_alpha,
                   has_exif, image_size)
from masks import find_masks, undistort_masks
from model import read_images
from products import (add_product_options, check_products, make_products, mesh_file,
                      product_commands, product_steps, textured, textured_meshes)
from structure_from_motion import ADVICE, find_poses, undistort

MIN_PHOTOS = 3
MAX_EXHAUSTIVE = 200  # Photos of which all pairs are compared without a remark.
LONG_STEREO = 20  # Minutes.
HEIC_ENDINGS = (".heic", ".heif")
HEIC_ADVICE = ("convert them by heif-convert a.heic a.jpg (package libheif-examples), or let the "
               "phone save JPEG")
FUSION_VIEWS = 5  # What stereo_fusion asks for by default.

DESCRIPTION = """\
Makes a refined point cloud of the photos in a folder and its subfolders (JPEG or
PNG). The steps:

  features, matches   what the photos have in common (colmap feature_extractor and
                      exhaustive_matcher, or the one of --matcher)
  sparse              camera poses (mapper); of several models the largest
  workspace           images without lens distortion (image_undistorter)
  masks               the same of the masks, with --mask_path
  stereo              a depth map of each image (tsar_stereo, or patch_match_stereo
                      with --stereo colmap)
  fusion_before       the cloud of these maps (tsar_fuse, or stereo_fusion with
                      --fusion colmap), to compare with
  refinement          tsar_refine: wrong depths go, bare surfaces are filled
  fusion_after        the cloud of the refined maps
  report              a page to look at (tsar_report)
  mesh, texture       if asked for: poisson_mesher or delaunay_mesher, and
                      mesh_texturer, which puts the photos on the mesh
  export              if asked for: python -m colmap_tsar export

What comes out:

  OUTPUT/after.ply, before.ply   the clouds with and without refinement
  OUTPUT/report/index.html       depth and normals before and after
  OUTPUT/mesh_poisson.ply, mesh_delaunay.ply
  OUTPUT/textured_poisson/, textured_delaunay/
  OUTPUT/export_FORMAT/
  OUTPUT/sparse/                 the model of the photos
  OUTPUT/dense/, refined/        dense workspaces with the maps before and after
  OUTPUT/masks/                  masks of the undistorted images
  OUTPUT/logs/                   what the programs printed, one file per step"""

EPILOG = """\
Give the same command again after an interruption: it goes on where it stopped.
With other options, the steps that depend on them are done again, and no others.

  a first look, in minutes even without a GPU
    scripts/reconstruct.sh photos out --max_image_size 480

  a mesh with the photos on it, and a folder for 3D Gaussian splatting
    scripts/reconstruct.sh photos out --mesh --texture --export 3dgs

  a video: two frames per second, each compared with the next ones
    ffmpeg -i video.mp4 -r 2 -qscale:v 2 frames/%05d.jpg
    scripts/reconstruct.sh frames out --matcher sequential

  without people and cars: masks as COLMAP takes them, that of photos/a.jpg being
  masks/a.jpg.png, black where the photo is to be ignored
    scripts/reconstruct.sh photos out --mask_path masks

  less, but surer points; and planes that are found in each image on its own
    scripts/reconstruct.sh photos out --TsarFuse.min_num_views 4 \\
        --TsarRefine.scene_planes 0

Options with a dot go to the command that has them (colmap COMMAND -h, colmap_tsar
COMMAND --help). docs/recipes.md tells what to do with the results."""


def read_photos(folder, output):
    """The photos' names, relative to their folder."""
    if not folder.is_dir():
        what = "is not a folder" if folder.exists() else "no such folder"
        raise DatasetError(f"{folder}: {what}; name the folder of the photos (frames of a video "
                           "are taken by ffmpeg; see --help)")
    if output == folder or folder in output.parents:
        raise DatasetError(f"{output}: is in the folder of the photos, where what is made would "
                           "be taken for photos; name an output folder elsewhere")
    names, others = find_photos(folder)
    heic = [ending for ending in others if ending in HEIC_ENDINGS]
    endings = ", ".join(IMAGE_ENDINGS)
    if not names:
        hint = f"; it has files with {', '.join(filter(None, others))}" if any(others) else ""
        raise DatasetError(f"{folder}: has no photos ({endings}){hint}; {HEIC_ADVICE if heic else 'convert them'}, or "
                           "name another folder")
    if len(names) < MIN_PHOTOS:
        raise DatasetError(f"{folder}: has {len(names)} photos; at least {MIN_PHOTOS} of the "
                           "same things are needed, and some 20 are better")
    for name in names:
        if not name.isprintable() or name != name.strip():
            raise DatasetError(f"{folder}: a file name that COLMAP cannot read, {name!a}; rename "
                               "the photo")
        check_photo(folder / name)
    if heic:
        print(f"{folder}: photos with {', '.join(heic)} are left out; {HEIC_ADVICE}", flush=True)
    num_with_alpha = sum(has_alpha(folder / name) for name in names)
    if num_with_alpha:
        print(f"{folder}: {num_with_alpha} photos have an alpha channel, which is ignored; give "
              "what is transparent as black in masks, --mask_path", flush=True)
    return names


def matcher_of(args):
    return args.matcher or "exhaustive"


def check_matcher(args, programs, num_photos, say):
    """That the matcher can run; and a remark where it takes long."""
    if args.vocab_tree and matcher_of(args) != "vocab_tree":
        raise DatasetError("--vocab_tree: is for --matcher vocab_tree")
    if args.vocab_tree and not os.path.isfile(args.vocab_tree):
        raise DatasetError(f"--vocab_tree {args.vocab_tree}: no such file")
    brings_tree = "vocab_tree_path arg (=" in programs.colmap_help("vocab_tree_matcher")
    if matcher_of(args) == "vocab_tree" and not args.vocab_tree and not brings_tree:
        raise DatasetError("--matcher vocab_tree: this COLMAP needs --vocab_tree FILE, a "
                           "vocabulary tree from COLMAP's web site")
    if args.matcher is None and num_photos > MAX_EXHAUSTIVE:
        say(f"{num_photos} photos: comparing all pairs may take hours; --matcher sequential is "
            "for the frames of a video, --matcher vocab_tree for others")


def warn_of_long_stereo(scene, args, programs, photos, names):
    """tsar_stereo on a CPU takes hours for photos as large as cameras make them."""
    if args.stereo != "tsar" or programs.tsar_uses_gpu:
        return
    megapixels = sum(dense.megapixels(*image_size(photos / name), args.max_image_size)
                     for name in names)
    minutes = megapixels * dense.STEREO_MINUTES / (os.cpu_count() or 1)
    if minutes > LONG_STEREO and scene.record("stereo")["state"] != "done":
        advice = ("480 is enough for a first look" if args.max_image_size > 480
                  else "fewer photos take less")
        scene.say(f"stereo on the CPU takes some {minutes / 60:.1f} hours at --max_image_size "
                  f"{args.max_image_size}; {advice}")


def take_fewer_views(args, num_images):
    """As many views of a point as there are, where stereo_fusion asks for more."""
    if args.min_num_pixels is None and num_images < FUSION_VIEWS:
        args.passed.setdefault("stereo_fusion", {}).setdefault(
            "StereoFusion.min_num_pixels", num_images)


def camera_options(scene, photos, names, passed):
    """Without EXIF, COLMAP calibrates each photo on its own, which fails for many. Those
    of one size are frames of a video, or come from elsewhere together."""
    given = any(name.startswith(("ImageReader.single_camera", "ImageReader.existing_camera"))
                for name in passed)
    if (given or len({image_size(photos / name) for name in names}) > 1
            or any(has_exif(photos / name) for name in names)):
        return passed
    scene.say("photos of one size without EXIF: taken as those of one camera; otherwise "
              "--ImageReader.single_camera 0")
    return {"ImageReader.single_camera": 1, **passed}


def make_sparse(scene, args, programs, photos, names, masks):
    """Features, matches, poses; returns the names of the images with poses."""
    passed = lambda command: args.passed.get(command, {})
    matcher = matcher_of(args)
    mapper = {"Mapper.min_model_size": MIN_PHOTOS, **passed("mapper")}
    tree = {"VocabTreeMatching.vocab_tree_path": args.vocab_tree} if args.vocab_tree else {}
    reader = {"ImageReader.mask_path": str(masks)} if masks else {}
    cameras = camera_options(scene, photos, names, {**reader, **passed("feature_extractor")})
    extract_features(scene, programs, photos, names, options=cameras)
    advice = ADVICE[matcher]
    if "ImageReader.single_camera" not in cameras:
        advice += "; for photos of one camera with one zoom, --ImageReader.single_camera 1"
    match_features(scene, programs, matcher, {**tree, **passed(f"{matcher}_matcher")})
    sparse = scene.folder / "sparse"
    scene.step(
        "sparse", lambda step: find_poses(step, programs, photos, sparse, advice, mapper),
        outputs=["sparse"], after=["matches"],
        options={**mapper, "colmap": programs.versions["colmap"]})
    found = {image.name for image in read_images(sparse / "images.txt")}
    missing = [name for name in names if name not in found]
    some = ", ".join(missing[:5]) + (", ..." if len(missing) > 5 else "")
    scene.say(f"{len(found)} of {len(names)} photos have a pose"
              + (f"; left out: {some}" if missing else "")
              + (f". For more: {advice}" if 2 * len(found) < len(names) else ""))
    return found


def make_masks(scene, programs, folder, names, size):
    """The masks of the undistorted images, or None where there are none. names:
    photos that have a mask and a pose."""
    if folder and not names:
        scene.say("no photo with a mask has a pose: going on without masks")
    return undistort_masks(scene, programs, folder, names, size) if names else None


def prior_options(args):
    """The options of tsar_refine for depth priors, name by value."""
    if not args.prior_path:
        if args.prior_type:
            raise DatasetError(f"--prior_type {args.prior_type}: says what depth priors mean; "
                               "give --prior_path as well")
        return {}
    folder = pathlib.Path(args.prior_path).resolve()
    if not folder.is_dir():
        raise DatasetError(f"--prior_path {args.prior_path}: no such folder")
    return {"prior_path": str(folder),
            **({"prior_type": args.prior_type} if args.prior_type else {})}


def reconstruct(args, programs):
    if args.undistorted_size is not None and args.undistorted_size < 16:
        raise DatasetError(f"--undistorted_size {args.undistorted_size}: is below 16")
    photos = pathlib.Path(args.photos).resolve()
    output = pathlib.Path(args.output).resolve()
    names = read_photos(photos, output)
    masks = pathlib.Path(args.mask_path).resolve() if args.mask_path else None
    masked = find_masks(masks, photos, output, names) if masks else []
    priors = prior_options(args)
    check_matcher(args, programs, len(names), lambda text: print(text, flush=True))
    check_products(args, programs)
    scene = dense.Scene(output.name, output, plan=[
        "features", "matches", "sparse", "workspace", *(["masks"] if masks else []),
        *(["stereo"] if args.stereo != "none" else []),
        "fusion_before", "refinement", "fusion_after", "report", *product_steps(args)])
    warn_of_long_stereo(scene, args, programs, photos, names)
    found = make_sparse(scene, args, programs, photos, names, masks)
    take_fewer_views(args, len(found))
    size = {"max_image_size": args.undistorted_size} if args.undistorted_size else {}
    dense.make_workspace(
        scene, lambda step: undistort(step, programs, photos, scene.folder / "sparse", size),
        after=["sparse"], options={**size, "colmap": programs.versions["colmap"]})
    dense_masks = make_masks(scene, programs, masks, [n for n in masked if n in found], size)
    dense.reconstruct(scene, args, programs, dense_masks, priors)
    make_report(scene, programs)
    make_products(scene, args, programs, dense_masks)
    summarize(scene, args)


def make_report(scene, programs):
    scene.step("report", lambda step: step.run(
        programs.tsar, "tsar_report", "--workspace_path", scene.folder / dense.REFINED,
        "--report_path", scene.folder / "report"),
        outputs=["report"], after=["refinement"],
        options={"colmap_tsar": programs.versions["colmap_tsar"]})
    if not ply.count(scene.folder / "after.ply", "vertex"):
        raise DatasetError(f"{scene.folder / 'after.ply'}: has no points, since the views agree "
                           f"nowhere; {scene.folder / 'report' / 'index.html'} shows their depth")


def summarize(scene, args):
    before, after = (ply.count(scene.folder / f"{name}.ply", "vertex")
                     for name in ("before", "after"))
    gain = f", {100 * (after / before - 1):+.0f} %" if before else ""
    scene.say(f"fused points before → after: {before} → {after}{gain}")
    scene.say(f"{scene.seconds(*scene.plan) / 60:.1f} minutes in all")
    scene.say(f"cloud: {scene.folder / 'after.ply'}")
    for kind in args.mesh:
        mesh = mesh_file(scene, kind)
        scene.say(f"mesh: {mesh} ({ply.count(mesh, 'face')} triangles)")
    for kind in textured_meshes(args):
        scene.say(f"textured mesh: {textured(scene, kind) / 'mesh.ply'}")
    for form in args.export:
        scene.say(f"export: {scene.folder / f'export_{form}'}")
    scene.say(f"open in a browser: {scene.folder / 'report' / 'index.html'}")


def commands_of(args):
    """The commands that take options from the command line."""
    return ["feature_extractor", f"{matcher_of(args)}_matcher", "mapper", *dense_commands(args),
            *product_commands(args)]


def main():
    parser = new_parser("reconstruct", DESCRIPTION, EPILOG)
    parser.add_argument("photos", metavar="PHOTOS", help="folder of the photos; it is only read")
    parser.add_argument("output", metavar="OUTPUT", help="folder for all that is made")
    parser.add_argument(
        "--matcher", choices=("exhaustive", "sequential", "vocab_tree"),
        help="which photos COLMAP compares: exhaustive, all with all (the default, for up to "
        f"{MAX_EXHAUSTIVE}); sequential, each with the next ones by name, for the frames of a "
        "video; vocab_tree, each with those that look alike")
    parser.add_argument("--vocab_tree", metavar="FILE",
                        help="vocabulary tree of --matcher vocab_tree, which COLMAP before 3.12 needs")
    parser.add_argument("--mask_path", metavar="MASKS",
                        help="folder with masks of the photos: that of PHOTOS/a/b.jpg is "
                        "MASKS/a/b.jpg.png, of the same size, black where the photo is to be "
                        "ignored, by features as well as by depth maps and clouds. Photos without "
                        "one are used as a whole. Masks get gray borders when they are "
                        "undistorted, and gray is not masked: draw them some pixels too wide")
    parser.add_argument("--prior_path", metavar="PRIORS",
                        help="folder with depth priors of the undistorted images, for "
                        "tsar_refine, whose help says how they are named; made of "
                        "OUTPUT/dense/images after a first run, they have only the "
                        "refinement and what follows it done anew")
    parser.add_argument("--prior_type", choices=("auto", "metric", "relative", "inverse"),
                        help="what the depth priors hold (default: auto)")
    parser.add_argument("--undistorted_size", type=int, metavar="PIXELS",
                        help="longer side of the undistorted images (default: as the photos)")
    add_options(parser, "OUTPUT")
    add_product_options(parser)
    run_main(parser, reconstruct, commands_of)


if __name__ == "__main__":
    main()
