# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
"""The steps that find and match features, by COLMAP."""
from database import clear_matches, read_image_ids, set_cameras
from files import write_text
from programs import as_words, files_named_by

DATABASE = "database.db"
ONE_CAMERA_PER_IMAGE = {"ImageReader.single_camera_per_image": 1}


def extract_features(scene, programs, image_folder, names, cameras=None,
                     options=ONE_CAMERA_PER_IMAGE):
    """cameras: those that are known, by image name. options: of feature_extractor,
    name by value."""
    database = scene.folder / DATABASE
    image_list = scene.folder / "images.txt"

    def action(step):
        write_text(image_list, "".join(f"{name}\n" for name in names))
        on_gpu = programs.gpu_option("feature_extractor", "SiftExtraction.use_gpu",
                                     "FeatureExtraction.use_gpu")
        step.run(programs.colmap, "feature_extractor", "--database_path", database,
                 "--image_path", image_folder, "--image_list_path", image_list,
                 *as_words({**on_gpu, **options}))
        if cameras:
            ids = read_image_ids(database)
            set_cameras(database, {ids[name][1]: cameras[name] for name in names if name in ids})

    known = {n: [c.model, c.width, c.height, *c.params] for n, c in (cameras or {}).items()}
    scene.step("features", action, outputs=[DATABASE], resumes=True,
               inputs=[*(image_folder / name for name in names), *files_named_by(options)],
               options={"names": names, "cameras": known, "options": options,
                        "colmap": programs.versions["colmap"]})


def match_features(scene, programs, matcher, options=None):
    """matcher: exhaustive, sequential or vocab_tree. options: of COLMAP's command,
    name by value."""
    database = scene.folder / DATABASE
    options = options or {}

    def action(step):
        # Pairs that have matches are not matched again.
        if not step.continued:
            clear_matches(database)
        command = f"{matcher}_matcher"
        on_gpu = programs.gpu_option(command, "SiftMatching.use_gpu", "FeatureMatching.use_gpu")
        step.run(programs.colmap, command, "--database_path", database,
                 *as_words({**on_gpu, **options}))

    scene.step("matches", action, outputs=[DATABASE], removes=False, resumes=True,
               after=["features"], inputs=files_named_by(options),
               options={"matcher": matcher, "options": options,
                        "colmap": programs.versions["colmap"]})
